//! Who is asked against whom.

use super::{Features, Recall, Sample};

/// The models asked, and the training models they are asked against.
#[derive(Debug, Clone, Copy)]
pub struct Exam<'a> {
    sample: &'a Sample,
    queries: bool,
}

impl<'a> Exam<'a> {
    /// Every training model against all the others.
    #[must_use]
    pub const fn leave_one_out(sample: &'a Sample) -> Self {
        Self { sample, queries: false }
    }

    /// Every query model against the training models.
    #[must_use]
    pub const fn queries(sample: &'a Sample) -> Self {
        Self { sample, queries: true }
    }

    /// The training models.
    #[must_use]
    pub const fn models(&self) -> &'a Features {
        &self.sample.train
    }

    /// The classes of the training models.
    #[must_use]
    pub fn labels(&self) -> &'a [u32] {
        &self.sample.train_labels
    }

    /// How many models are asked.
    #[must_use]
    pub const fn len(&self) -> usize {
        if self.queries { self.sample.query.rows() } else { self.sample.train.rows() }
    }

    /// True when none is.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The features of the model asked.
    ///
    /// # Panics
    /// When `asked` is not below [`Exam::len`].
    #[must_use]
    pub fn row(&self, asked: usize) -> &'a [f64] {
        if self.queries { self.sample.query.row(asked) } else { self.sample.train.row(asked) }
    }

    /// Its true class.
    ///
    /// # Panics
    /// When `asked` is not below [`Exam::len`].
    #[must_use]
    pub fn label(&self, asked: usize) -> u32 {
        if self.queries { self.sample.query_labels[asked] } else { self.sample.train_labels[asked] }
    }

    /// The training model that it is itself, and is not asked against.
    #[must_use]
    pub const fn left_out(&self, asked: usize) -> Option<usize> {
        if self.queries { None } else { Some(asked) }
    }

    /// How many models of its class each asked model is asked against: the Q of its ADR.
    #[must_use]
    pub fn relevant(&self) -> Vec<usize> {
        let sizes = self.sample.class_sizes();
        let itself = usize::from(!self.queries);
        (0..self.len()).map(|asked| sizes[self.label(asked) as usize] - itself).collect()
    }

    /// The arithmetic of ADR for this exam.
    #[must_use]
    pub fn recall(&self) -> Recall {
        Recall::new(&self.relevant())
    }
}
