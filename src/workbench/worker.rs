//! The thread that owns the host, so that the screen's never waits.
//!
//! Commands go in, answers come out; of several settings in the queue the newest wins. While spectra are being solved
//! the study is made again and again on the models that are there.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError, mpsc},
    thread::JoinHandle,
    time::{Duration, Instant},
};

use super::{
    Command, Trial, Update,
    experiment::{Told, Varied},
    journal::Weight,
    shape::Painter,
    trial::Recall,
    watcher::{Sight, Watcher},
};
use crate::{
    dataset::{self, DataSet},
    query::{Config, Host, Members, News, Piece, Question, Reply, Settings},
    report::paper::variation::Subject,
    store::Store,
};

mod asked;
mod errands;
mod telling;

/// Where the models are and how they are worked on.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The folder.
    pub root: PathBuf,
    /// Split files.
    pub options: dataset::Options,
    /// The parameters to begin with.
    pub settings: Settings,
    /// Where spectra are kept between sessions.
    pub store: Store,
    /// How many models are solved at once.
    pub threads: usize,
}

impl Setup {
    fn open(&self) -> Result<DataSet, String> {
        dataset::open(&self.root, &self.options).map_err(|error| error.to_string())
    }
}

enum Message {
    Command(Command),
    News(News),
    Piece(u64, Piece),
    /// The study of that number is over, finished or not.
    Over(u64),
    /// The answer to a question of the asking of that number.
    Reply(u64, Reply),
    /// A surface that was read after so many looks at the folder.
    Surface(u64, Reply),
    /// Figures under other parameters.
    Trial(Trial),
    /// How far the spectra of a trial are.
    Trying(Settings, usize, usize),
    /// News of the paper's document.
    Paper(Told),
    /// How far Figure 1 of this is.
    Varying(Arc<Subject>, usize),
    /// Figure 1.
    Varied(Arc<Varied>),
    /// The data set changed.
    Changed,
    /// A file was written, or why not.
    Written(PathBuf, Result<(), String>),
}

/// The worker. Dropping it asks the thread to end and does not wait for a long computation.
#[derive(Debug)]
pub struct Worker {
    messages: mpsc::Sender<Message>,
    painter: Painter,
    thread: Option<JoinHandle<()>>,
}

/// How long [`Worker`]'s drop waits for the thread to put its things in order.
const PATIENCE: Duration = Duration::from_millis(100);
/// After a change of parameters the first answer waits so long for the new values, so that the screen changes once.
const GRACE: Duration = Duration::from_millis(12);
/// The study of models that are not all there yet begins so long after a change: a store that has them all is quicker.
const FIRST_STUDY: Duration = Duration::from_millis(120);
/// So often is a file that could not be read looked at again by itself, and after so long.
const LOOKS: u8 = 5;
const LOOK: Duration = Duration::from_millis(400);
/// Progress is told so often at most.
const PROGRESS: Duration = Duration::from_millis(100);

impl Worker {
    /// Opens the data set on a thread of its own and goes to work. `notify` is called on that thread and on the one
    /// that paints, never on both at once.
    ///
    /// # Errors
    /// When the system has no thread to give.
    pub fn spawn(setup: Setup, notify: impl Fn(Update) + Send + 'static) -> std::io::Result<Self> {
        // Two threads have news to tell, one at a time.
        let shared = Arc::new(Mutex::new(notify));
        let (notify, paint) = (one_at_a_time(&shared), one_at_a_time(&shared));
        let painter = Painter::start(move |scene, picture| paint(Update::Picture(scene, picture)))?;
        let (messages, inbox) = mpsc::channel();
        let outbox = messages.clone();
        let thread = std::thread::Builder::new().name("worker".into()).spawn(move || {
            // Looked at before it is opened, so that no change falls between the two.
            let seen = Sight::of(&setup);
            let work = || match setup.open() {
                Ok(data) => {
                    let news = outbox.clone();
                    let changed = move || {
                        let _ = news.send(Message::Changed);
                    };
                    let watcher = Watcher::start(setup.clone(), seen, changed);
                    Desk::new(setup, data, outbox, &notify).work(&inbox);
                    drop(watcher);
                }
                Err(reason) => notify(Update::Fatal(reason)),
            };
            if catch_unwind(AssertUnwindSafe(work)).is_err() {
                notify(Update::Fatal("internal error in the worker, please report it".into()));
            }
        })?;
        Ok(Self { messages, painter, thread: Some(thread) })
    }

    /// Passes a command on; never waits.
    pub fn send(&self, command: Command) {
        if let Command::Paint(scenes) = command {
            self.painter.paint(scenes);
            return;
        }
        // Without a receiver the worker has told why it ended.
        let _ = self.messages.send(Message::Command(command));
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.send(Command::Quit);
        let deadline = Instant::now() + PATIENCE;
        if let Some(thread) = self.thread.take() {
            while !thread.is_finished() && Instant::now() < deadline {
                std::thread::sleep(Duration::from_millis(2));
            }
        }
    }
}

/// Calls what is shared, waiting while another thread does.
fn one_at_a_time<T: Fn(Update)>(shared: &Arc<Mutex<T>>) -> impl Fn(Update) + use<T> {
    let shared = Arc::clone(shared);
    move |update| (*shared.lock().unwrap_or_else(PoisonError::into_inner))(update)
}

/// The worker's state.
struct Desk<'a> {
    setup: Setup,
    host: Host,
    outbox: mpsc::Sender<Message>,
    notify: &'a dyn Fn(Update),
    /// The study under way: its number, its models and when it began.
    study: Option<(u64, Members, Instant)>,
    /// The models of the last study that was finished under the parameters in force.
    studied: Option<Members>,
    /// Not before this is a study of more models begun, unless they are all there.
    next_study: Instant,
    studies: u64,
    /// What the screen wants to know, and how often it was asked.
    questions: Vec<Question>,
    askings: u64,
    /// How often the folder was looked at.
    sights: u64,
    /// Calls off the trials under way.
    recall: Recall,
    /// Call off the paper's document and the Figure 1 under way.
    paper: Recall,
    varying: Recall,
    told: telling::Told,
    publish_at: Option<Instant>,
    saved: bool,
    /// Looks at the folder that are left for files that were in the middle of a change, and when the next one is due.
    looks: u8,
    look_at: Option<Instant>,
}

impl<'a> Desk<'a> {
    fn new(setup: Setup, data: DataSet, outbox: mpsc::Sender<Message>, notify: &'a dyn Fn(Update)) -> Self {
        let config =
            Config { data, settings: setup.settings.clone(), store: setup.store.clone(), threads: setup.threads };
        let news = outbox.clone();
        let host = Host::with_listener(
            config,
            Arc::new(move |item| {
                let _ = news.send(Message::News(item));
            }),
        );
        let now = Instant::now();
        Self {
            setup,
            host,
            outbox,
            notify,
            study: None,
            studied: None,
            next_study: now + FIRST_STUDY,
            studies: 0,
            questions: Vec::new(),
            askings: 0,
            sights: 0,
            recall: Recall::default(),
            paper: Recall::default(),
            varying: Recall::default(),
            told: telling::Told::begin(),
            publish_at: Some(now),
            saved: false,
            looks: LOOKS,
            look_at: None,
        }
    }

    fn work(mut self, inbox: &mpsc::Receiver<Message>) {
        loop {
            let first = match self.wait() {
                Some(wait) => match inbox.recv_timeout(wait) {
                    Ok(message) => Some(message),
                    Err(mpsc::RecvTimeoutError::Timeout) => None,
                    Err(mpsc::RecvTimeoutError::Disconnected) => return,
                },
                None => match inbox.recv() {
                    Ok(message) => Some(message),
                    Err(_) => return,
                },
            };
            let (mut newest, mut asked) = (None, None);
            for message in first.into_iter().chain(inbox.try_iter()) {
                match message {
                    Message::Command(Command::Set(settings)) => newest = Some(settings),
                    Message::Command(Command::Ask(questions)) => asked = Some(questions),
                    Message::Command(Command::Look(questions)) => self.look(questions),
                    Message::Command(Command::Write { path, content, overwrite }) => {
                        self.write(path, content, overwrite);
                    }
                    Message::Changed => {
                        self.looks = LOOKS;
                        self.obey(&Command::Rescan);
                    }
                    Message::Written(path, outcome) => self.written(path, outcome),
                    Message::Command(Command::Try(settings)) => self.try_out(settings),
                    Message::Trial(trial) => self.tried(trial),
                    Message::Trying(settings, done, total) => (self.notify)(Update::Trying(settings, done, total)),
                    Message::Paper(told) => self.paper_told(told),
                    Message::Varying(subject, done) => (self.notify)(Update::Varying(subject, done)),
                    Message::Varied(varied) => (self.notify)(Update::Varied(varied)),
                    Message::Command(Command::Paper(folder)) => self.write_paper(folder),
                    Message::Command(Command::StopPaper) => self.paper.call(),
                    Message::Command(Command::Vary(subject)) => self.vary(subject),
                    Message::Command(Command::StopVarying) => self.varying.call(),
                    Message::Command(Command::Quit) => {
                        self.recall.call();
                        self.paper.call();
                        self.varying.call();
                        self.host.save();
                        return;
                    }
                    Message::Command(command) => {
                        self.looks = LOOKS;
                        self.obey(&command);
                    }
                    Message::News(news) => {
                        self.host.hear(news);
                        self.publish_within(PROGRESS);
                    }
                    Message::Piece(number, piece) => self.learn(number, piece),
                    Message::Over(number) => self.over(number),
                    Message::Reply(number, reply) => self.reply(number, reply),
                    Message::Surface(sight, reply) => self.surface(sight, reply),
                }
            }
            if let Some(settings) = newest {
                self.turn(settings);
            }
            self.look_again();
            let begun = self.begin_study();
            if let Some(questions) = asked {
                self.questions = questions;
                self.ask();
            } else if begun {
                self.ask();
            }
            if self.publish_at.is_some_and(|at| at <= Instant::now()) {
                self.publish_at = None;
                let answer = Arc::new(self.host.answer());
                self.account(&answer);
                (self.notify)(Update::Answer(answer));
            }
            if self.host.complete() && !std::mem::replace(&mut self.saved, true) {
                self.host.save();
            }
        }
    }

    fn obey(&mut self, command: &Command) {
        match command {
            Command::Rescan => match self.setup.open() {
                Ok(data) => {
                    self.note(Weight::Note, "looked at the files again");
                    self.host.update(data);
                    self.sights += 1;
                    (self.notify)(Update::Rescanned);
                    self.saved = false;
                    self.restudy();
                }
                Err(reason) => self.host.warn(&reason),
            },
            Command::Stop => self.host.stop(),
            Command::Resume => self.host.resume(),
            Command::Set(_)
            | Command::Ask(_)
            | Command::Look(_)
            | Command::Try(_)
            | Command::Write { .. }
            | Command::Paper(_)
            | Command::StopPaper
            | Command::Vary(_)
            | Command::StopVarying
            | Command::Paint(_)
            | Command::Quit => {}
        }
        self.publish_within(GRACE);
    }

    /// A file that is written while it is read comes right by itself.
    fn look_again(&mut self) {
        if self.look_at.is_some_and(|at| at <= Instant::now()) {
            self.look_at = None;
            self.looks -= 1;
            self.obey(&Command::Rescan);
        } else if self.look_at.is_none() && self.looks > 0 && self.host.complete() && self.host.unread() {
            self.look_at = Some(Instant::now() + LOOK);
        }
    }

    /// Forgets the study under way: the host's write has ended it.
    fn restudy(&mut self) {
        self.study = None;
        self.studied = None;
        self.next_study = Instant::now() + FIRST_STUDY;
    }

    /// The models to study, where a study of them would say more than the last one: all that will be there, or so many
    /// more that the figures may move. The database keeps what each study found, so there must not be hundreds.
    fn worth_a_study(&self) -> Option<Members> {
        let members = self.host.members()?;
        let worth = match &self.studied {
            None => true,
            Some(studied) if self.host.complete() || self.host.stopped() => *studied != members,
            Some(studied) => members.places.len() > studied.places.len() * 9 / 8,
        };
        worth.then_some(members)
    }

    /// Begins the study if it is due. Returns whether it did.
    fn begin_study(&mut self) -> bool {
        if self.study.is_some() || (Instant::now() < self.next_study && !self.host.complete()) {
            return false;
        }
        let Some(members) = self.worth_a_study() else { return false };
        self.studies += 1;
        let number = self.studies;
        let inquiry = self.host.inquire(members.clone());
        let outbox = self.outbox.clone();
        let begun = std::thread::Builder::new().name("study".into()).spawn(move || {
            let over = outbox.clone();
            inquiry.run(&move |piece| {
                let _ = outbox.send(Message::Piece(number, piece));
            });
            let _ = over.send(Message::Over(number));
        });
        match begun {
            Ok(_) => self.study = Some((number, members, Instant::now())),
            Err(error) => self.host.warn(&format!("the system has no thread to give: {error}")),
        }
        self.study.is_some()
    }

    fn learn(&mut self, number: u64, piece: Piece) {
        if let Some((current, members, _)) = &self.study
            && *current == number
        {
            self.host.learn(members, piece);
            self.publish_within(GRACE / 2);
        }
    }

    fn over(&mut self, number: u64) {
        if let Some((_, members, begun)) = self.study.take_if(|(current, ..)| *current == number) {
            // A study of more models costs about as much again: leave the solving most of the time.
            self.next_study = Instant::now() + (begun.elapsed() * 4).max(Duration::from_millis(500));
            self.note_study(members.places.len(), begun.elapsed());
            self.studied = Some(members);
            self.publish_within(Duration::ZERO);
        }
    }

    fn publish_within(&mut self, time: Duration) {
        let at = Instant::now() + time;
        self.publish_at = Some(self.publish_at.map_or(at, |before| before.min(at)));
    }

    /// How long nothing needs to be done, unless a message comes; none for ever.
    fn wait(&self) -> Option<Duration> {
        let study = (self.study.is_none() && self.worth_a_study().is_some()).then_some(self.next_study);
        let at = [self.publish_at, study, self.look_at].into_iter().flatten().min()?;
        Some(at.saturating_duration_since(Instant::now()))
    }
}
