//! What takes long and is asked for once: the paper's document, the variants of a shape. Each has a thread of its own
//! and can be called off.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::Arc,
};

use super::{Desk, Message};
use crate::{
    dataset::Role,
    query::Settings,
    remesh,
    report::paper::{self, variation},
    watch::Watch as _,
    workbench::{
        experiment::{Told, Varied},
        journal::Weight,
        trial::{Recall, Watching},
    },
};

impl Desk<'_> {
    /// Writes the paper's document, with a host of its own that shares the spectra.
    pub(super) fn write_paper(&mut self, folder: PathBuf) {
        self.paper.call();
        self.paper = Recall::default();
        let settings = self.host.settings().clone();
        let (mut host, recall) = (self.host.beside(settings), self.paper.clone());
        let (outbox, root) = (self.outbox.clone(), self.setup.root.display().to_string());
        self.note(Weight::Note, &format!("writing the paper's document to {}", folder.display()));
        let begun = std::thread::Builder::new().name("paper".into()).spawn(move || {
            let tell = outbox.clone();
            let watch = Watching::new(recall, move |done, total| {
                let _ = tell.send(Message::Paper(Told::Progress(done, total)));
            });
            let written = catch_unwind(AssertUnwindSafe(|| paper::write(&mut host, &root, &folder, &watch)));
            let outcome = match written {
                Ok(Ok(files)) => Ok(files.len()),
                Ok(Err(error)) => Err(error.to_string()),
                Err(_) => Err("internal error in the document, please report it".to_owned()),
            };
            let _ = outbox.send(Message::Paper(Told::Done(outcome)));
        });
        if let Err(error) = begun {
            let reason = format!("the system has no thread to give: {error}");
            let _ = self.outbox.send(Message::Paper(Told::Done(Err(reason))));
        }
    }

    /// Makes and solves the variants of the class's first training model.
    pub(super) fn vary(&mut self, settings: Settings) {
        self.varying.call();
        self.varying = Recall::default();
        let answer = self.host.answer();
        let class = settings.class;
        let first = answer.models.iter().find(|model| model.class as usize == class && model.role == Role::Train);
        let path = first.map(|model| model.path.clone());
        let singles = self.host.singles();
        let (recall, outbox, threads) = (self.varying.clone(), self.outbox.clone(), self.setup.threads);
        let begun = std::thread::Builder::new().name("variants".into()).spawn(move || {
            let vertices = settings.remesh.unwrap_or(remesh::USUAL);
            let variants = match path {
                Some(path) => catch_unwind(AssertUnwindSafe(|| {
                    variation::of_file(&singles, &path, settings.choice(), vertices, threads, &recall)
                }))
                .unwrap_or_else(|_| Err("internal error in the variants, please report it".to_owned())),
                None => Err("the class has no training model".to_owned()),
            };
            if !recall.cancelled() {
                let variants = variants.map(Arc::new);
                let _ = outbox.send(Message::Varied(Arc::new(Varied { settings, variants })));
            }
        });
        if let Err(error) = begun {
            self.host.warn(&format!("the system has no thread to give: {error}"));
        }
    }
}
