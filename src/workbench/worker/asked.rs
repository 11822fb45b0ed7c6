//! What the worker does for the screen besides the study: questions, surfaces, trials, files. Each has a thread of its
//! own, so that the study never waits for it.

use std::{io::Write as _, path::PathBuf, sync::Arc};

use super::{
    super::{
        Content, Update,
        trial::{self, Recall},
    },
    Desk, Message,
};
use crate::query::{Question, Reply, Settings};

impl Desk<'_> {
    /// Asks what the screen wants to know, each question on a thread of its own. What is asked about the study waits
    /// until there is one.
    pub(super) fn ask(&mut self) {
        self.askings += 1;
        let number = self.askings;
        let members = self.study.as_ref().map(|(_, members, _)| members).or(self.studied.as_ref());
        for question in &self.questions {
            let outbox = self.outbox.clone();
            let tell = move |reply: Reply| {
                let _ = outbox.send(Message::Reply(number, reply));
            };
            let thread = std::thread::Builder::new().name("question".into());
            let Some(members) = members.cloned() else { continue };
            let asking = self.host.ask(members, question.clone());
            let begun = thread.spawn(move || {
                if let Some(reply) = asking.answer() {
                    tell(reply);
                }
            });
            if let Err(error) = begun {
                self.host.warn(&format!("the system has no thread to give: {error}"));
            }
        }
    }

    /// Reads surfaces, all on one thread: nobody looks at several at once for long.
    pub(super) fn look(&mut self, questions: Vec<Question>) {
        let looking: Vec<_> = questions.into_iter().filter_map(|question| self.host.look(question)).collect();
        let (outbox, sight) = (self.outbox.clone(), self.sights);
        let begun = std::thread::Builder::new().name("surfaces".into()).spawn(move || {
            for looking in looking {
                let _ = outbox.send(Message::Surface(sight, looking.answer()));
            }
        });
        if let Err(error) = begun {
            self.host.warn(&format!("the system has no thread to give: {error}"));
        }
    }

    /// Passes a surface on, unless the folder was looked at again meanwhile: the file may be another by now, the model
    /// may have another place, and the screen has asked again.
    pub(super) fn surface(&self, sight: u64, reply: Reply) {
        if sight == self.sights {
            (self.notify)(Update::Reply(Arc::new(reply)));
        }
    }

    /// Writes a file on a thread of its own: the disk may be a slow one, and a figure is drawn first.
    pub(super) fn write(&mut self, path: PathBuf, content: Content, overwrite: bool) {
        let outbox = self.outbox.clone();
        let begun = std::thread::Builder::new().name("writer".into()).spawn(move || {
            let bytes = match content.bytes() {
                Ok(bytes) => bytes,
                Err(reason) => {
                    let _ = outbox.send(Message::Written(path, Err(reason)));
                    return;
                }
            };
            let mut options = std::fs::OpenOptions::new();
            options.write(true);
            if overwrite {
                options.create(true).truncate(true)
            } else {
                options.create_new(true)
            };
            let written = options.open(&path).and_then(|mut file| file.write_all(&bytes));
            let outcome = written.map_err(|error| match error.kind() {
                std::io::ErrorKind::AlreadyExists => "there is such a file already; choose another name".to_owned(),
                _ => format!("cannot be written: {error}"),
            });
            let _ = outbox.send(Message::Written(path, outcome));
        });
        if let Err(error) = begun {
            self.host.warn(&format!("the system has no thread to give: {error}"));
        }
    }

    /// Makes the study under other parameters, on a thread with a host of its own that shares the spectra.
    pub(super) fn try_out(&mut self, settings: Vec<Settings>) {
        self.recall.call();
        self.recall = Recall::default();
        let Some(first) = settings.first() else { return };
        let (host, recall, outbox) = (self.host.beside(first.clone()), self.recall.clone(), self.outbox.clone());
        let begun = std::thread::Builder::new().name("trial".into()).spawn(move || {
            let trying = |settings: &Settings, done: usize, total: usize| {
                let _ = outbox.send(Message::Trying(settings.clone(), done, total));
            };
            let tell = |trial| {
                let _ = outbox.send(Message::Trial(trial));
            };
            trial::run(host, settings, &recall, &tell, &trying);
        });
        if let Err(error) = begun {
            self.host.warn(&format!("the system has no thread to give: {error}"));
        }
    }

    /// Passes an answer on, unless the screen asks for something else by now.
    pub(super) fn reply(&self, number: u64, reply: Reply) {
        if number == self.askings {
            (self.notify)(Update::Reply(Arc::new(reply)));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::RefCell, sync::mpsc, time::Duration};

    use super::*;
    use crate::{
        mesh::{self, synth},
        query::Settings,
        store::Store,
        workbench::{Command, worker::Setup},
    };

    #[test]
    fn a_surface_of_before_the_last_look_at_the_folder_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        for (class, model) in [("a", 0), ("a", 1), ("b", 0), ("b", 1)] {
            let mesh =
                synth::generate(&synth::Options { vertices: 300, ..synth::Options::default() }, 0, model).unwrap();
            let path = folder.path().join(class).join(format!("{model}.obj"));
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            mesh::write::obj(&mesh, &mut std::fs::File::create(path).unwrap()).unwrap();
        }
        let setup = Setup {
            root: folder.path().to_owned(),
            options: crate::dataset::Options::default(),
            settings: Settings { kmax: 5, ..Settings::default() },
            store: Store::none(),
            threads: 1,
        };
        let (data, told) = (setup.open().unwrap(), RefCell::new(Vec::new()));
        let (outbox, inbox) = mpsc::channel();
        let notify = |update| told.borrow_mut().push(update);
        let mut desk = Desk::new(setup, data, outbox, &notify);
        let surface = || loop {
            if let Message::Surface(sight, reply) = inbox.recv_timeout(Duration::from_secs(30)).unwrap() {
                return (sight, reply);
            }
        };
        let shapes = || told.borrow().iter().filter(|update| matches!(update, Update::Reply(_))).count();
        desk.look(vec![Question::Shape(0)]);
        let (sight, reply) = surface();
        desk.surface(sight, reply.clone());
        assert_eq!(shapes(), 1);
        desk.obey(&Command::Rescan);
        desk.surface(sight, reply);
        assert_eq!(shapes(), 1);
        desk.look(vec![Question::Shape(0)]);
        let (sight, reply) = surface();
        desk.surface(sight, reply);
        assert_eq!(shapes(), 2);
    }
}
