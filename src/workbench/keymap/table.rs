//! The table itself: a row for keys that belong together.

use super::{
    super::{Action, View, parameters},
    Context, Key, Row,
};
use crate::query::Parameter;

/// Lines of a step of the wheel.
const WHEEL: isize = 3;

/// All of it.
pub(super) fn rows() -> Vec<Row> {
    [in_views(), in_one_view(), explaining(), elsewhere()].concat()
}

fn in_views() -> Vec<Row> {
    use Context::Views;
    use Key::{BackTab, Char, Ctrl, Down, End, Enter, F, Home, Left, PageDown, PageUp, Right, Tab, Up};
    vec![
        (Views, vec![(Left, Action::Turn(-1)), (Right, Action::Turn(1))], "← →", "turn the parameter", "turn"),
        (Views, vec![(Char('-'), Action::Turn(-1)), (Char('+'), Action::Turn(1))], "- +", "the same", ""),
        (
            Views,
            vec![
                (Key::ShiftLeft, Action::Leap(-1)),
                (Key::ShiftRight, Action::Leap(1)),
                (Char('<'), Action::Leap(-1)),
                (Char('>'), Action::Leap(1)),
            ],
            "< >  Shift-← →",
            "turn it by a big step",
            "",
        ),
        (
            Views,
            vec![(Up, Action::Up), (Down, Action::Down)],
            "↑ ↓",
            "the parameter before, after; the line in a list",
            "choose",
        ),
        (Views, letters(), "", "choose that parameter: operator, mass, kmax, …", ""),
        (Views, vec![(Enter, Action::Edit), (Char('='), Action::Edit)], "", "type a value", "type"),
        (Views, vec![(Char('r'), Action::Reset)], "", "the parameter's first value", ""),
        (Views, vec![(Char('R'), Action::ResetAll)], "", "every parameter's first value", ""),
        (Views, vec![(Char('u'), Action::Undo)], "", "undo the last change of parameters", "undo"),
        (Views, vec![(Char('U'), Action::Redo), (Ctrl('r'), Action::Redo)], "", "redo", ""),
        (Views, numbers(), "1 – 0", "show that view", "view"),
        (
            Views,
            vec![(Tab, Action::NextView), (BackTab, Action::PreviousView)],
            "",
            "the next view, the one before",
            "",
        ),
        (
            Views,
            vec![(PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "scroll the view, or page through the models",
            "",
        ),
        (Views, vec![(Home, Action::First), (End, Action::Last)], "", "to the beginning, to the end", ""),
        (
            Views,
            vec![(Key::Backspace, Action::Back), (Key::Esc, Action::Back)],
            "",
            "back to what was looked at before",
            "",
        ),
        (Views, vec![(Char('z'), Action::ToggleAlone)], "", "the view alone, or with the parameters", ""),
        (Views, vec![(Char(' '), Action::ToggleSolving)], "", "stop solving spectra, go on", ""),
        (Views, vec![(F(5), Action::Rescan)], "", "look at the files again", ""),
        (
            Views,
            vec![(Char(':'), Action::Palette), (Ctrl('p'), Action::Palette)],
            "",
            "every command, and any class, model or eigenvalue",
            "find",
        ),
        (Views, vec![(Char('/'), Action::Find)], "", "list only what has a text in its name or class", ""),
        (
            Views,
            vec![(Char('v'), Action::CycleSort), (Char('V'), Action::ReverseSort)],
            "",
            "list in another order, the other way round",
            "",
        ),
        (Views, vec![(Char('W'), Action::WriteView)], "", "write what the view shows: a figure or its table", ""),
        (
            Views,
            vec![(Char('X'), Action::WritePaper)],
            "",
            "write the paper's document to a folder, or call it off",
            "",
        ),
        (Views, vec![(Char('J'), Action::Journal)], "", "the journal: what the engine did, and how long it took", ""),
        (Views, vec![(Char('M'), Action::ToggleMouse)], "", "listen to the mouse: wheel and click, or no longer", ""),
        (Views, wheel(), "Wheel ↑ Wheel ↓", "scroll the list or the view", ""),
        (Views, vec![(Char('S'), Action::WriteRecipe)], "", "write the session as a recipe", ""),
        (Views, vec![(Char('C'), Action::Copy)], "", "copy what the view shows", ""),
        (Views, vec![(Char('L'), Action::Restore)], "", "take up the last session of the data set", ""),
        (Views, vec![(Char('P'), Action::Pin)], "", "put the settings aside as a pin", ""),
        (Views, vec![(Char('Y'), Action::Sweep)], "", "sweep over the chosen parameter", ""),
        (Views, vec![(Char('?'), Action::Help), (F(1), Action::Help)], "", "this help", "help"),
        (Views, vec![(Char('q'), Action::Quit)], "", "quit", "quit"),
    ]
}

fn in_one_view() -> Vec<Row> {
    use Context::In;
    use Key::Char;
    vec![
        (In(View::Overview), vec![(Char('g'), Action::ToggleAxis)], "", "the k axis logarithmic or linear", "axis"),
        (In(View::Curves), vec![(Char('g'), Action::ToggleAxis)], "", "the k axis logarithmic or linear", "axis"),
        (
            In(View::Curves),
            vec![(Char('f'), Action::TurnFace)],
            "",
            "Figures 3 and 6 of all spectra, Figure 7, Figure 1",
            "figure",
        ),
        (
            In(View::Curves),
            vec![(Char(','), Action::StepSpectrum(-1)), (Char('.'), Action::StepSpectrum(1))],
            "",
            "the spectrum before, after in the list of all",
            "spectrum",
        ),
        (In(View::Curves), vec![(Char('a'), Action::Switch)], "", "switch the spectrum, or Figure 1, on or off", "on"),
        (In(View::Curves), vec![(Char('A'), Action::SwitchOff)], "", "switch all spectra off", ""),
        (
            In(View::Selection),
            vec![(Char('f'), Action::ToggleFigure)],
            "",
            "Figure 5, Figure 4, hill climbing, shared bands",
            "figure",
        ),
        (
            In(View::Selection),
            vec![(Char('a'), Action::Compare)],
            "",
            "keep the class beside others, or no longer",
            "add class",
        ),
        (In(View::Selection), vec![(Char('g'), Action::ToggleAxis)], "", "the index axis of the shared bands", ""),
        (In(View::Selection), vec![(Char('A'), Action::CompareNone)], "", "the parameter's class alone", ""),
        (
            In(View::Models),
            vec![(Char('w'), Action::CycleFilter)],
            "",
            "all, with defects, taking no part, not solved yet",
            "filter",
        ),
        (In(View::Models), vec![(Char('a'), Action::ListAll)], "", "list all models", ""),
    ]
}

/// The views that lead from a figure to the models behind it.
fn explaining() -> Vec<Row> {
    use Context::In;
    use Key::{Char, Down, Enter, Left, Right, Up};
    let open = |view, about| (In(view), vec![(Enter, Action::Open)], "", about, "open");
    let method = |view| {
        let keys = vec![(Char('['), Action::TurnMethod(-1)), (Char(']'), Action::TurnMethod(1))];
        (In(view), keys, "", "the method before, after", "method")
    };
    let step = |view| {
        let keys = vec![(Char(','), Action::Step(-1)), (Char('.'), Action::Step(1))];
        (In(view), keys, "", "the model before, after", "model")
    };
    vec![
        open(View::Models, "the model's neighbours"),
        (In(View::Pipeline), vec![(Up, Action::Up), (Down, Action::Down)], "↑ ↓", "the stage before, after", "stage"),
        open(View::Pipeline, "the stage's models, or what it makes"),
        (
            In(View::Confusion),
            vec![
                (Up, Action::Cell(-1, 0)),
                (Down, Action::Cell(1, 0)),
                (Left, Action::Cell(0, -1)),
                (Right, Action::Cell(0, 1)),
            ],
            "← → ↑ ↓",
            "move the cell",
            "cell",
        ),
        open(View::Confusion, "list the models of the cell"),
        (
            In(View::Confusion),
            vec![(Char('.'), Action::NextConfusion)],
            "",
            "the fullest wrong cell, then the next",
            "worst",
        ),
        (In(View::Confusion), vec![(Char('a'), Action::TellApart)], "", "what tells the cell's classes apart", "apart"),
        method(View::Confusion),
        (In(View::Confusion), vec![(Char('b'), Action::CycleSide)], "", "count D and Q, D alone, Q alone", "D/Q"),
        open(View::Neighbours, "go to the neighbour"),
        step(View::Neighbours),
        (In(View::Neighbours), vec![(Char('p'), Action::ShowShape)], "", "the model as a shape", "shape"),
        (In(View::Models), vec![(Char('p'), Action::ShowShape)], "", "the model as a shape", "shape"),
        method(View::Neighbours),
        (
            In(View::Shape),
            vec![
                (Left, Action::Orbit(-1, 0)),
                (Right, Action::Orbit(1, 0)),
                (Up, Action::Orbit(0, 1)),
                (Down, Action::Orbit(0, -1)),
            ],
            "← → ↑ ↓",
            "turn the shape",
            "turn",
        ),
        (
            In(View::Shape),
            vec![
                (Key::PageUp, Action::Approach(1)),
                (Key::PageDown, Action::Approach(-1)),
                (Key::WheelUp, Action::Approach(1)),
                (Key::WheelDown, Action::Approach(-1)),
            ],
            "PgUp PgDn  Wheel ↑ Wheel ↓",
            "nearer, farther",
            "nearer",
        ),
        (In(View::Shape), vec![(Key::Home, Action::FirstLook)], "", "as seen at first", ""),
        step(View::Shape),
        (
            In(View::Shape),
            vec![(Char('e'), Action::TurnFunction(1)), (Char('E'), Action::TurnFunction(-1))],
            "",
            "colour by the next eigenfunction, the one before",
            "eigenfunction",
        ),
        (In(View::Shape), vec![(Char('w'), Action::NoFunction)], "", "without colour", ""),
        method(View::Compare),
        (In(View::Compare), vec![(Enter, Action::Recall)], "", "take the settings of the pin", "take"),
        (In(View::Compare), vec![(Char('D'), Action::Unpin)], "", "remove the pin", "remove"),
        (In(View::Compare), vec![(Char('f'), Action::ToggleSweep)], "", "the pins or the sweep", "sweep"),
        (In(View::Compare), vec![(Char('g'), Action::ToggleAxis)], "", "the sweep's axis logarithmic or linear", ""),
        (In(View::Shape), vec![(Char('f'), Action::ToggleStyle)], "", "dots or blocks", "style"),
        (
            In(View::Neighbours),
            vec![(Char('f'), Action::ToggleOverlay)],
            "",
            "what each eigenvalue adds, or the two spectra",
            "spectra",
        ),
    ]
}

fn elsewhere() -> Vec<Row> {
    use Context::{Always, Entry, Help, Journal, Palette};
    use Key::{Char, Ctrl, Down, End, Enter, Esc, F, Home, Left, PageDown, PageUp, Right, Up};
    vec![
        (Entry, vec![(Enter, Action::Commit)], "", "take what was typed", "take it"),
        (Entry, vec![(Esc, Action::Close)], "", "leave everything as it was", "leave it"),
        (Entry, vec![(Key::Tab, Action::NextEnding)], "", "another kind of file: csv, json, txt, svg, png", ""),
        (Entry, vec![(Key::Backspace, Action::Erase)], "", "erase a character", ""),
        (Entry, vec![(Ctrl('u'), Action::EraseAll)], "", "erase everything before the caret", ""),
        (Entry, vec![(Left, Action::Left), (Right, Action::Right)], "← →", "move the caret", ""),
        (Palette, vec![(Enter, Action::Pick)], "", "do it", "do it"),
        (Palette, vec![(Esc, Action::Close), (Ctrl('p'), Action::Close)], "", "close the palette", "close"),
        (
            Palette,
            vec![(Up, Action::Up), (Down, Action::Down), (PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "choose a line",
            "choose",
        ),
        (Palette, wheel(), "Wheel ↑ Wheel ↓", "choose a line", ""),
        (Palette, vec![(Key::Backspace, Action::Erase)], "", "erase a character", ""),
        (Palette, vec![(Ctrl('u'), Action::EraseAll)], "", "erase everything before the caret", ""),
        (Palette, vec![(Left, Action::Left), (Right, Action::Right)], "← →", "move the caret", ""),
        (
            Help,
            vec![(Up, Action::Up), (Down, Action::Down), (PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "scroll",
            "scroll",
        ),
        (Help, wheel(), "Wheel ↑ Wheel ↓", "scroll", ""),
        (Help, vec![(Home, Action::First), (End, Action::Last)], "", "to the beginning, to the end", ""),
        (
            Journal,
            vec![(Up, Action::Up), (Down, Action::Down), (PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "scroll",
            "scroll",
        ),
        (Journal, wheel(), "Wheel ↑ Wheel ↓", "scroll", ""),
        (Journal, vec![(Home, Action::First), (End, Action::Last)], "", "to the newest line, to the oldest", ""),
        (
            Journal,
            vec![(Esc, Action::Close), (Char('J'), Action::Close), (Char('q'), Action::Close)],
            "",
            "close the journal",
            "close",
        ),
        (
            Help,
            vec![(Esc, Action::Close), (Char('?'), Action::Close), (Char('q'), Action::Close), (F(1), Action::Close)],
            "",
            "close the help",
            "close",
        ),
        (Always, vec![(Ctrl('c'), Action::Interrupt)], "", "quit at once", ""),
        (Always, vec![(Ctrl('z'), Action::Suspend)], "", "back to the shell; fg returns", ""),
        (Always, vec![(Ctrl('l'), Action::Redraw)], "", "draw the screen anew", ""),
    ]
}

fn wheel() -> Vec<(Key, Action)> {
    vec![(Key::WheelUp, Action::Scroll(-WHEEL)), (Key::WheelDown, Action::Scroll(WHEEL))]
}

fn letters() -> Vec<(Key, Action)> {
    parameters::in_order().map(|parameter| (Key::Char(parameters::letter(parameter)), choose(parameter))).collect()
}

const fn choose(parameter: Parameter) -> Action {
    Action::Choose(parameter)
}

fn numbers() -> Vec<(Key, Action)> {
    ('1'..='9').chain(['0']).zip(View::ALL).map(|(digit, view)| (Key::Char(digit), Action::Show(view))).collect()
}

pub(super) fn names(keys: &[(Key, Action)]) -> String {
    keys.iter().map(|(key, _)| key.name()).collect::<Vec<_>>().join(" ")
}
