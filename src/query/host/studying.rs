//! The study: on which models it is made, and how its values come in.

use std::{
    sync::{Arc, mpsc},
    time::Duration,
};

use super::{Cancelled, Host, Shown};
use crate::{
    dataset::Role,
    query::{
        Answer, Finding, Part, Question, Singles,
        inquiry::{Inquiry, Members, Piece},
        library::Failure,
        question::{Asking, Looking, ModelAt},
    },
    selection::Cost,
    watch::Watch,
};

/// So often a run looks whether it was cancelled.
const TICK: Duration = Duration::from_millis(5);

impl Host {
    /// Solves other files and meshes beside the study, which shares all spectra with them.
    #[must_use]
    pub fn singles(&self) -> Singles {
        Singles::over(self.library.apart())
    }

    /// The models whose spectra are there; none while they cannot make a study (two training models at least).
    pub(crate) fn members(&self) -> Option<Members> {
        let kmax = self.settings.kmax;
        let ready = self.rows.iter().enumerate().filter_map(|(place, row)| match &row.found {
            Some(Ok(solved)) if solved.eigenvalues.len() >= kmax => Some((place, row.file, solved.eigenvalues.len())),
            _ => None,
        });
        let ready: Vec<_> = ready.collect();
        let train = ready.iter().filter(|(_, file, _)| file.role(&self.database) == Role::Train).count();
        (train >= 2).then(|| Members {
            places: Arc::new(ready.iter().map(|&(place, ..)| place).collect()),
            files: ready.iter().map(|&(_, file, _)| file).collect(),
            reach: ready.iter().map(|&(_, _, count)| count).min().unwrap_or(kmax).min(self.reach),
        })
    }

    /// Prepares the study of `members` for another thread.
    pub(crate) fn inquire(&self, members: Members) -> Inquiry {
        Inquiry::new(self.database.clone(), members)
    }

    /// Prepares a question about `members` for another thread.
    pub(crate) fn ask(&self, members: Members, question: Question) -> Asking {
        Asking::new(self.database.clone(), members, self.settings.clone(), question)
    }

    /// Answers a question about the models that have been studied, as [`Host::run`] leaves them.
    ///
    /// # Errors
    /// [`Cancelled`] once the watch says so; within, why there is nothing to be found.
    pub fn find(&mut self, question: Question, watch: &dyn Watch) -> Result<Result<Finding, Failure>, Cancelled> {
        let Some(members) = self.members() else { return Ok(Err("there are no models to compare".into())) };
        let asking = self.ask(members, question);
        let (sender, replies) = mpsc::channel();
        let thread = std::thread::spawn(move || sender.send(asking.answer()));
        let reply = loop {
            match replies.recv_timeout(TICK) {
                Err(mpsc::RecvTimeoutError::Timeout) if watch.cancelled() => {
                    self.abandon();
                    return Err(Cancelled);
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Ok(reply) => break reply,
                Err(mpsc::RecvTimeoutError::Disconnected) => break None,
            }
        };
        let _ = thread.join();
        Ok(reply.map_or_else(|| Err("internal error in the study, please report it".into()), |reply| reply.finding))
    }

    /// Prepares the reading of a model's surface, or a function on it, on another thread. None when there is no such
    /// model, or the question is another.
    pub(crate) fn look(&self, question: Question) -> Option<Looking> {
        let (Question::Shape(model) | Question::Function { model, .. }) = question else { return None };
        let file = ModelAt::of(&self.database, self.rows.get(model)?.file);
        let problem = self.settings.problem();
        Some(Looking { library: self.library.clone(), file, settings: self.settings.clone(), problem, question })
    }

    /// Takes in a value of the study of `members`.
    pub(crate) fn learn(&mut self, members: &Members, piece: Piece) {
        // What is there of other models is not what this study will say, once no more models are to come.
        if self.shown.places != members.places && self.complete() {
            self.shown.outdate();
        }
        self.shown.places = Arc::clone(&members.places);
        let shown = &mut self.shown;
        match piece {
            Piece::FirstK(value) => shown.first_k = Part::fresh(value),
            Piece::Climb(Cost::Error, value) => shown.climb_error = Part::fresh(value),
            Piece::Climb(Cost::Adr, value) => shown.climb_adr = Part::fresh(value),
            Piece::Boosted(value) => shown.boosted = Part::fresh(value),
            Piece::Marks(value) => shown.marks = Part::fresh(value),
            Piece::Tables(value) => shown.tables = Part::fresh(value),
            Piece::Failed(reason) => self.failure = Some(reason),
        }
    }

    /// Solves everything and makes the study: the whole experiment, without a screen.
    ///
    /// `watch` hears of models (finished, all) and is polled every few milliseconds.
    ///
    /// # Errors
    /// [`Cancelled`] once the watch says so; finished spectra and bands are kept.
    pub fn run(&mut self, watch: &dyn Watch) -> Result<Answer, Cancelled> {
        if self.stopped {
            self.resume();
        }
        watch.progress(0, self.rows.len());
        while !self.complete() {
            if watch.cancelled() {
                self.stop();
                self.save();
                return Err(Cancelled);
            }
            let heard = self.news.as_ref().and_then(|news| news.recv_timeout(TICK).ok());
            if let Some(news) = heard
                && self.hear(news)
            {
                watch.progress(self.rows.iter().filter(|row| row.found.is_some()).count(), self.rows.len());
            }
        }
        self.save();
        if let Some(members) = self.members() {
            let inquiry = self.inquire(members.clone());
            let (sender, pieces) = mpsc::channel();
            let study = std::thread::spawn(move || {
                inquiry.run(&|piece| {
                    let _ = sender.send(piece);
                });
            });
            loop {
                match pieces.recv_timeout(TICK) {
                    Ok(piece) => self.learn(&members, piece),
                    Err(mpsc::RecvTimeoutError::Disconnected) => break,
                    Err(mpsc::RecvTimeoutError::Timeout) if watch.cancelled() => {
                        self.abandon();
                        return Err(Cancelled);
                    }
                    Err(mpsc::RecvTimeoutError::Timeout) => {}
                }
            }
            let _ = study.join();
        } else {
            self.shown = Shown::default();
        }
        Ok(self.answer())
    }

    /// Stops the study that is being made; it leaves within some 10 ms.
    pub(crate) fn abandon(&mut self) {
        self.database.write(salsa::Database::trigger_cancellation);
    }
}
