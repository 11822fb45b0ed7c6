//! What takes long and is asked for once: the paper's document, Figure 1 alone. Each has a thread of its own
//! and can be called off.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::Arc,
};

use super::{Desk, Message};
use crate::{
    report::paper::{
        self,
        variation::{self, Subject},
    },
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

    /// Makes Figure 1.
    pub(super) fn vary(&mut self, subject: Subject) {
        self.varying.call();
        self.varying = Recall::default();
        let (singles, threads) = (self.host.singles(), self.setup.threads);
        let (recall, outbox) = (self.varying.clone(), self.outbox.clone());
        let told = Arc::new(subject.clone());
        let asked = Arc::clone(&told);
        let begun = std::thread::Builder::new().name("figure 1".into()).spawn(move || {
            let tell = outbox.clone();
            let watch = Watching::new(recall, move |done, _| {
                let _ = tell.send(Message::Varying(Arc::clone(&told), done));
            });
            let made = AssertUnwindSafe(|| variation::of_class(&singles, &subject, threads, &watch));
            let variation =
                catch_unwind(made).unwrap_or_else(|_| Err("internal error in Figure 1, please report it".to_owned()));
            if !watch.cancelled() {
                let _ = outbox.send(Message::Varied(Arc::new(Varied { subject, variation })));
            }
        });
        if let Err(error) = begun {
            let variation = Err(format!("the system has no thread to give: {error}"));
            let _ = self.outbox.send(Message::Varied(Arc::new(Varied { subject: (*asked).clone(), variation })));
        }
    }
}
