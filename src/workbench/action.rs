//! Everything that can happen to the state, and everything the state can ask for.

use super::{Command, Update, View, shape::Raster};
use crate::query::Parameter;

/// Something that happened: a key's meaning, or news.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Leave, as asked.
    Quit,
    /// Leave, as interrupted.
    Interrupt,
    /// Hand the terminal back to the shell for a while.
    Suspend,
    /// Draw everything anew.
    Redraw,
    /// Show or hide the help.
    Help,
    /// Close what is open above the view.
    Close,
    /// Show a view.
    Show(View),
    /// Show the next view.
    NextView,
    /// Show the view before.
    PreviousView,
    /// Choose a parameter.
    Choose(Parameter),
    /// Turn the chosen parameter by so many steps.
    Turn(isize),
    /// Turn it by so many big steps.
    Leap(isize),
    /// Begin to type a value.
    Edit,
    /// Give the chosen parameter its first value back.
    Reset,
    /// Give every parameter its first value back.
    ResetAll,
    /// Take back the last change of parameters.
    Undo,
    /// Take back the last undo.
    Redo,
    /// Look at the files again.
    Rescan,
    /// Stop or resume solving.
    ToggleSolving,
    /// One line up: the parameter before, the model before, the help's line before.
    Up,
    /// One line down.
    Down,
    /// A page up.
    PageUp,
    /// A page down.
    PageDown,
    /// To the first line.
    First,
    /// To the last line.
    Last,
    /// Switch the k axis between logarithmic and linear.
    ToggleAxis,
    /// Switch between Figure 5 and Figure 4.
    ToggleFigure,
    /// Compare the class shown with others, or no longer.
    Compare,
    /// What tells the class of the cell from the class it is taken for.
    TellApart,
    /// Compare no classes.
    CompareNone,
    /// List other models: all of them, those with a defect, and so on.
    CycleFilter,
    /// List what the view lists in another order.
    CycleSort,
    /// List it the other way round.
    ReverseSort,
    /// List all models.
    ListAll,
    /// Explain another method, so many places further.
    TurnMethod(isize),
    /// Count other models in the confusion matrix.
    CycleSide,
    /// The two spectra over each other, or the terms of their distance.
    ToggleOverlay,
    /// Move the cell of the confusion matrix: down and to the right.
    Cell(isize, isize),
    /// To the fullest wrong cell after this one.
    NextConfusion,
    /// Open what the cursor is on.
    Open,
    /// Back to what was looked at before.
    Back,
    /// Turn the shape to the right and upwards, by steps.
    Orbit(i32, i32),
    /// Go nearer to the shape, or farther, by steps.
    Approach(i32),
    /// See the shape as at first.
    FirstLook,
    /// Colour the shape by an eigenfunction so many indices further.
    TurnFunction(isize),
    /// Colour the shape by the eigenfunction of this index, from 1.
    Eigenfunction(usize),
    /// Colour the shape by no function.
    NoFunction,
    /// Draw shapes with dots or with blocks.
    ToggleStyle,
    /// Show the model looked at as a shape.
    ShowShape,
    /// Give the view the whole screen, or no longer.
    ToggleAlone,
    /// Open the command palette.
    Palette,
    /// Pick the palette's line.
    Pick,
    /// Type what the models listed have in their name or class.
    Find,
    /// Set a parameter to a value, given as text.
    Set(Parameter, String),
    /// Look at a model's neighbours.
    LookAt(usize),
    /// Put the settings on the screen aside.
    Pin,
    /// Remove the pin that the cursor is on.
    Unpin,
    /// Take the settings of the pin that the cursor is on.
    Recall,
    /// Type the name of a file for what the view shows.
    WriteView,
    /// The next ending of the file's name that is typed.
    NextEnding,
    /// Type the name of a file for the session.
    WriteRecipe,
    /// Give what the view shows to the terminal to copy.
    Copy,
    /// Take up the last session.
    Restore,
    /// Show something else in the view of curves: the next of the paper's figures.
    TurnFace,
    /// The spectrum before or after in the list of the view of curves.
    StepSpectrum(isize),
    /// Switch on, or off, what the view of curves offers to compute.
    Switch,
    /// Switch off every spectrum.
    SwitchOff,
    /// Write the paper's whole document, or call off the one that is being written.
    WritePaper,
    /// Show or hide the journal.
    Journal,
    /// Listen to the mouse, or no longer.
    ToggleMouse,
    /// Move the list or the view by so many lines, and no parameter.
    Scroll(isize),
    /// Sweep over the chosen parameter.
    Sweep,
    /// Show the sweep instead of the pins, or no longer.
    ToggleSweep,
    /// The model before or after, wherever a model is shown.
    Step(isize),
    /// A character typed into the entry.
    Insert(char),
    /// Delete the character before the entry's caret.
    Erase,
    /// Delete everything before the entry's caret.
    EraseAll,
    /// Move the entry's caret left.
    Left,
    /// Move the entry's caret right.
    Right,
    /// Take the entry's value.
    Commit,
    /// The screen has this size now, columns and rows.
    Resize(u16, u16),
    /// The screen takes pictures of shapes, and how.
    Pictures(Raster),
    /// News from the engine.
    News(Update),
    /// Something the user should know, in one line.
    Report(String),
}

/// What the state asks of the world outside.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Send this to the engine.
    Send(Command),
    /// End the session.
    Leave(Leave),
    /// Hand the terminal back to the shell until the shell continues us.
    Suspend,
    /// Draw everything anew, whatever the terminal shows.
    Redraw,
    /// Give a text to the terminal to copy.
    Copy(String),
    /// Listen to the mouse, or no longer.
    Mouse(bool),
}

/// How a session ends at the user's wish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leave {
    /// Done.
    Quit,
    /// Interrupted.
    Interrupt,
}
