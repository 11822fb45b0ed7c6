//! What the view shown wants to know beyond the study, and what was answered.
//!
//! [`questions`] follows from the state alone: whoever changes the state need not think of it. What no view shows is
//! never asked for.

use std::sync::Arc;

use super::{
    Figure, State, View, experiment, explore, parameters, pins,
    shape::{self, Camera, Function, Scene},
};
use crate::{
    query::{Finding, Parameter, Question, Reply, Stage},
    study::Method,
};

/// Answers kept: turning back to a model or a method that was just shown shows it at once.
const KEPT: usize = 24;

/// From so many columns on the selection view shows all its figures at once.
pub const ALL_FIGURES: u16 = 150;

/// The newest answers, the newest last.
#[derive(Debug, Clone, Default)]
pub struct Replies(Vec<Arc<Reply>>);

impl Replies {
    /// Takes in an answer; an older one to the same question goes.
    pub fn take(&mut self, reply: Arc<Reply>) {
        self.0.retain(|kept| kept.question != reply.question);
        if self.0.len() == KEPT {
            self.0.remove(0);
        }
        self.0.push(reply);
    }

    /// The answer to a question, if there is one.
    #[must_use]
    pub fn find(&self, question: &Question) -> Option<&Arc<Reply>> {
        self.0.iter().rev().find(|reply| reply.question == *question)
    }

    /// Forgets all surfaces.
    pub fn clear_surfaces(&mut self) {
        self.0.retain(|kept| !matches!(kept.question, Question::Shape(_) | Question::Function { .. }));
    }

    /// Forgets everything: the models have other places now.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// Everything that the screen as it is wants to know.
#[must_use]
pub fn questions(state: &State) -> Vec<Question> {
    let method = state.why.method;
    match state.view {
        View::Selection if state.figure == Figure::Shared || state.size.0 >= ALL_FIGURES => {
            let class = state.settings.class;
            let apart = state.opposed().map(|other| Question::Apart { class, other });
            std::iter::once(Question::Shared(class)).chain(apart).collect()
        }
        View::Confusion => vec![Question::Decisions(method)],
        View::Curves if experiment::asks_retrieval(state) => vec![Question::Retrieval],
        // The paired tests need what every method decides, here and for each pin.
        View::Compare | View::Tables if !state.pins.is_empty() => pins::questions(),
        View::Neighbours => state.model().map(|model| Question::Reasons { method, model }).into_iter().collect(),
        _ => Vec::new(),
    }
}

/// What is to be known of the shapes shown, without what is there or on its way.
#[must_use]
pub fn surfaces(state: &State) -> Vec<Question> {
    let shown = match state.view {
        View::Models | View::Neighbours => pictured(state).into_iter().map(Question::Shape).collect(),
        View::Shape => {
            let of = |model: usize| {
                let function = state.function.map(|index| Question::Function { model, index });
                std::iter::once(Question::Shape(model)).chain(function)
            };
            state.model().into_iter().flat_map(of).collect()
        }
        _ => Vec::new(),
    };
    let there = |question: &Question| state.replies.find(question).is_some_and(|reply| !state.outdated(reply));
    shown.into_iter().filter(|question| !there(question) && !state.looked_for.contains(question)).collect()
}

/// The models of which there are small pictures: the one looked at, and in the view of neighbours those around the
/// cursor.
#[must_use]
pub fn pictured(state: &State) -> Vec<usize> {
    let room = shape::thumbs(state.size);
    let Some(model) = state.model().filter(|_| room > 0) else { return Vec::new() };
    if state.view != View::Neighbours {
        return vec![model];
    }
    let models = explore::neighbours(state).map_or_else(Vec::new, |(_, models)| models);
    let first = first_pictured(state, models.len());
    std::iter::once(model).chain(models.into_iter().skip(first).take(room - 1)).collect()
}

/// The place of the first neighbour that has a small picture.
#[must_use]
pub fn first_pictured(state: &State, neighbours: usize) -> usize {
    let room = shape::thumbs(state.size).saturating_sub(1);
    let at = state.why.neighbour.min(neighbours.saturating_sub(1));
    at.saturating_sub(room.saturating_sub(1))
}

/// Everything that the screen as it is wants painted: what can be, of the surfaces that are there.
#[must_use]
pub fn scenes(state: &State) -> Vec<Scene> {
    let mesh = |model: usize| match &state.replies.find(&Question::Shape(model))?.finding {
        Ok(Finding::Shape(mesh)) => Some(Arc::clone(mesh)),
        _ => None,
    };
    let scene = |model: usize, camera: Camera, cells: (u16, u16)| {
        let found = state.function.and_then(|index| {
            let question = Question::Function { model, index };
            match &state.replies.find(&question).filter(|reply| !state.outdated(reply))?.finding {
                Ok(Finding::Function(values)) => Some(Function { index, values: Arc::clone(values) }),
                _ => None,
            }
        });
        // Until it is there the one before stays: the shape without any would be a picture for a moment.
        let awaited = state.function.is_some_and(|index| {
            found.is_none() && matches!(state.answered(&Question::Function { model, index }), Answered::Awaited)
        });
        let before = || state.scenes.iter().find(|scene| scene.model == model && awaited)?.function.clone();
        let function = found.or_else(before).filter(|_| cells != shape::THUMB);
        // Small pictures are many, and characters do for them.
        let small = cells == shape::THUMB && state.style == shape::Style::Pixels;
        let style = if small { shape::Style::Dots } else { state.style };
        Some(Scene { model, mesh: mesh(model)?, function, camera, cells, style, raster: state.raster })
    };
    match state.view {
        View::Shape => {
            let whole = state.model().and_then(|model| scene(model, state.camera, shape::cells(state.size)));
            whole.into_iter().collect()
        }
        View::Models | View::Neighbours => {
            // Small pictures keep their distance, and turn with the large one.
            let camera = Camera { zoom: 0, ..state.camera };
            pictured(state).into_iter().filter_map(|model| scene(model, camera, shape::THUMB)).collect()
        }
        _ => Vec::new(),
    }
}

/// What a view can say of a question.
#[derive(Debug, Clone, Copy)]
pub enum Answered<'a> {
    /// It was asked, and the answer is on its way.
    Awaited,
    /// There is nothing, and why.
    Nothing(&'a str),
    /// What was found; true while it belongs to other parameters or fewer models.
    Found(&'a Finding, &'a [usize], bool),
}

impl State {
    /// What is known of a question.
    #[must_use]
    pub fn answered(&self, question: &Question) -> Answered<'_> {
        match self.replies.find(question) {
            None => Answered::Awaited,
            Some(reply) => match &reply.finding {
                Ok(finding) => Answered::Found(finding, &reply.places, self.outdated(reply)),
                Err(_) if self.outdated(reply) => Answered::Awaited,
                Err(reason) => Answered::Nothing(reason),
            },
        }
    }

    /// True while an answer belongs to other parameters than those on the screen, or to other models than the study.
    #[must_use]
    pub fn outdated(&self, reply: &Reply) -> bool {
        let matters = |parameter: Parameter| {
            let stage = match reply.question {
                Question::Shape(_) => return false,
                // More eigenvalues do not change those that are there.
                Question::Function { .. } if parameter == Parameter::Kmax => return false,
                Question::Function { .. } => Stage::Spectrum,
                Question::Shared(_) | Question::Apart { .. } => Stage::Features,
                // Every method has a part in them; what is only read off a method's rows has none.
                Question::Retrieval | Question::Honest | Question::Tuned | Question::Splits => {
                    return !matches!(parameter, Parameter::K | Parameter::Cost | Parameter::Sel | Parameter::Class);
                }
                Question::Decisions(method) | Question::Reasons { method, .. } => {
                    if method == Method::FirstK && parameter == Parameter::K {
                        return true;
                    }
                    stage(method)
                }
            };
            parameters::invalidates(parameter).contains(&stage)
        };
        let differs = |parameter: Parameter| self.settings.get(parameter) != reply.settings.get(parameter);
        Parameter::ALL.into_iter().any(|parameter| differs(parameter) && matters(parameter))
            || (!matches!(reply.question, Question::Shape(_) | Question::Function { .. })
                && reply.places.len() != self.answer.members.len())
    }
}

/// The stage that a method's decisions come from.
#[must_use]
pub const fn stage(method: Method) -> Stage {
    match method {
        Method::FirstK | Method::BestK => Stage::FirstK,
        Method::ClimbError => Stage::ClimbError,
        Method::ClimbAdr => Stage::ClimbAdr,
        Method::Boost => Stage::Boost,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::Settings;

    fn reply(question: Question) -> Arc<Reply> {
        let settings = Settings::default();
        Arc::new(Reply { question, settings, places: Arc::default(), finding: Err("nothing".into()) })
    }

    #[test]
    fn the_newest_answers_are_kept() {
        let mut replies = Replies::default();
        for model in 0..2 * KEPT {
            replies.take(reply(Question::Shape(model)));
            replies.take(reply(Question::Shape(model)));
        }
        assert!(replies.find(&Question::Shape(2 * KEPT - 1)).is_some());
        assert!(replies.find(&Question::Shape(KEPT)).is_some());
        assert!(replies.find(&Question::Shape(KEPT - 1)).is_none());
    }

    #[test]
    fn an_answer_is_outdated_by_what_it_depends_on() {
        let mut state = State::new("", Settings::default());
        let outdated = |state: &State, question| state.outdated(&reply(question));
        state.settings.k = 7;
        assert!(outdated(&state, Question::Decisions(Method::FirstK)));
        assert!(!outdated(&state, Question::Decisions(Method::BestK)));
        state.settings = Settings { rounds: 7, ..Settings::default() };
        assert!(outdated(&state, Question::Reasons { method: Method::Boost, model: 0 }));
        assert!(!outdated(&state, Question::Reasons { method: Method::ClimbAdr, model: 0 }));
        state.settings = Settings { kmax: 7, ..Settings::default() };
        assert!(outdated(&state, Question::Shared(0)));
        assert!(!outdated(&state, Question::Shape(0)));
    }

    #[test]
    fn only_what_is_shown_is_asked_for() {
        let mut state = State::new("", Settings::default());
        for view in View::ALL {
            state.view = view;
            let none = !matches!(view, View::Confusion);
            assert_eq!(questions(&state).is_empty(), none, "{view:?}");
        }
        // The differences to pins stand in two views, and so do their paired tests.
        pins::pin(&mut state).unwrap();
        for view in [View::Tables, View::Compare] {
            state.view = view;
            assert_eq!(questions(&state), pins::questions(), "{view:?}");
        }
    }
}
