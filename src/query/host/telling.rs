//! What the host says of the data set and of its own work, as plain data.

use std::{sync::Arc, time::Duration};

use super::{Host, Row};
use crate::{
    dataset::Model,
    query::{Answer, ModelRow, ModelState, Progress, Stage, StageRow, heap},
};

impl Host {
    /// Everything that is known now, as plain data.
    pub(crate) fn answer(&mut self) -> Answer {
        self.serial += 1;
        let models: Vec<ModelRow> = self.rows.iter().zip(&self.data.models).map(|(row, m)| self.row(row, m)).collect();
        let progress = self.progress(&models);
        let mut warnings = self.data.warnings.clone();
        warnings.extend(self.library.store().warnings());
        warnings.extend(self.failure.as_ref().map(ToString::to_string));
        // Values on fewer models than there are by now are the newest there can be while spectra are being solved.
        if self.complete() && self.members().is_some_and(|members| members.places != self.shown.places) {
            self.shown.outdate();
        }
        let shown = &self.shown;
        Answer {
            serial: self.serial,
            settings: self.settings.clone(),
            layout: self.data.layout.clone(),
            classes: Arc::clone(&self.classes),
            stages: self.stages(&models),
            models: Arc::new(models),
            members: Arc::clone(&shown.places),
            progress,
            first_k: shown.first_k.clone(),
            climb_error: shown.climb_error.clone(),
            climb_adr: shown.climb_adr.clone(),
            boosted: shown.boosted.clone(),
            marks: shown.marks.clone(),
            tables: shown.tables.clone(),
            short: self.too_short(),
            memory: heap::memory(),
            warnings: Arc::new(warnings),
        }
    }

    fn row(&self, row: &Row, model: &Model) -> ModelRow {
        let kmax = self.settings.kmax;
        let state = match (&row.found, row.working) {
            (Some(Err((_, reason))), _) => ModelState::Out { reason: reason.to_string() },
            (Some(Ok(solved)), _) if solved.eigenvalues.len() >= kmax => ModelState::Ready {
                source: solved.found.source,
                count: solved.eigenvalues.len(),
                seconds: solved.found.seconds,
            },
            (Some(Ok(solved)), _) if solved.found.spectrum.order < kmax => {
                let order = solved.found.spectrum.order;
                ModelState::Out {
                    reason: format!("the mesh has {order} eigenvalues, fewer than kmax = {kmax}; lower kmax to use it"),
                }
            }
            (_, Some((done, total))) => ModelState::Working { done, total },
            (_, None) => ModelState::Waiting,
        };
        let solved = row.found.as_ref().and_then(|found| found.as_ref().ok());
        let mut defects: Vec<String> =
            row.facts.iter().flat_map(|facts| facts.survey.defects.iter().map(ToString::to_string)).collect();
        // What was asked for is no defect.
        let asked = self.settings.problem().note();
        let notes = solved.iter().flat_map(|solved| &solved.found.spectrum.notes);
        defects.extend(notes.filter(|note| asked.as_ref() != Some(note)).cloned());
        ModelRow {
            name: model.name.clone(),
            path: model.path.clone(),
            class: model.class,
            role: model.role,
            state,
            size: row.facts.as_ref().map(|facts| (facts.survey.vertices, facts.survey.triangles)),
            measure: solved.map(|solved| solved.found.spectrum.measure),
            defects: Arc::new(defects),
            eigenvalues: solved.map(|solved| Arc::clone(&solved.eigenvalues)),
        }
    }

    /// One line that says which models kmax leaves out.
    fn too_short(&self) -> Option<String> {
        let kmax = self.settings.kmax;
        let orders = self.rows.iter().filter_map(|row| row.found.as_ref()?.as_ref().ok());
        let orders: Vec<usize> = orders.map(|solved| solved.found.spectrum.order).filter(|&n| n < kmax).collect();
        let least = orders.iter().min()?;
        Some(format!(
            "{} of {} models have fewer than kmax = {kmax} eigenvalues and take no part; with kmax = {least} all would",
            orders.len(),
            self.rows.len(),
        ))
    }

    fn progress(&self, models: &[ModelRow]) -> Progress {
        let ready = models.iter().filter(|row| matches!(row.state, ModelState::Ready { .. })).count();
        let out = models.iter().filter(|row| matches!(row.state, ModelState::Out { .. })).count();
        let mut progress = Progress { ready, out, total: models.len(), rate: None, left: None };
        let open = models.len() - ready - out;
        if let (Some(first), Some(last)) = (self.solved_at.front(), self.solved_at.back())
            && self.solved_at.len() >= 2
            && open > 0
            && !self.stopped
        {
            // To now rather than to the last: the rate falls while nothing arrives.
            let span = first.elapsed().min(last.duration_since(*first) + Duration::from_secs(2)).as_secs_f64();
            let rate = (self.solved_at.len() - 1) as f64 / span.max(1e-3);
            progress.rate = Some(rate);
            progress.left = Duration::try_from_secs_f64(open as f64 / rate).ok();
        }
        progress
    }

    fn stages(&self, models: &[ModelRow]) -> Vec<StageRow> {
        let failed_at =
            |stage| self.rows.iter().filter(|row| matches!(&row.found, Some(Err((at, _))) if *at == stage)).count();
        let shown = &self.shown;
        let row = |stage: Stage| {
            let tally = self.library.trace().tally(stage);
            let failed = failed_at(stage);
            let (needed, there) = match stage {
                Stage::Content => (models.len(), self.rows.iter().filter(|row| row.past(stage)).count()),
                Stage::Survey => (models.len(), self.rows.iter().filter(|row| row.past(stage)).count()),
                Stage::Spectrum => {
                    let open =
                        models.iter().filter(|m| matches!(m.state, ModelState::Waiting | ModelState::Working { .. }));
                    (models.len(), models.len() - open.count() - self.rows.iter().filter(|row| row.failed()).count())
                }
                Stage::Features | Stage::FirstK => (1, usize::from(!shown.first_k.stale)),
                Stage::ClimbError => (1, usize::from(!shown.climb_error.stale)),
                Stage::ClimbAdr => (1, usize::from(!shown.climb_adr.stale)),
                Stage::Boost => (1, usize::from(!shown.boosted.stale)),
                Stage::Tables => (1, usize::from(!shown.tables.stale)),
            };
            let failed_before = Stage::ALL.into_iter().filter(|&s| s < stage).map(failed_at).sum::<usize>();
            let needed = if stage <= Stage::Spectrum { needed - failed_before } else { needed };
            let (ran, disk) = (tally.ran, tally.disk);
            let memory = there.saturating_sub(ran + disk);
            let saved = match stage {
                Stage::Content | Stage::Survey => self.library.costs().mean(stage) * (memory + disk) as f64,
                Stage::Spectrum => {
                    let cost = self.rows.iter().filter_map(|row| row.found.as_ref()?.as_ref().ok());
                    (cost.map(|solved| solved.found.seconds).sum::<f64>() - tally.ran_busy.as_secs_f64()).max(0.0)
                }
                _ => self.library.trace().cost(stage).as_secs_f64() * memory as f64,
            };
            StageRow {
                stage,
                ran,
                disk,
                memory,
                saved,
                stale: needed.saturating_sub(there + failed),
                failed,
                seconds: tally.busy.as_secs_f64(),
            }
        };
        Stage::ALL.into_iter().map(row).collect()
    }
}

impl Row {
    /// Whether the file's bytes could not be had.
    pub(super) fn unread(&self) -> bool {
        matches!(self.found, Some(Err((Stage::Content, _))))
    }

    fn failed(&self) -> bool {
        matches!(self.found, Some(Err(_)))
    }

    /// Whether the model got through `stage`, one of the first two.
    fn past(&self, stage: Stage) -> bool {
        match &self.found {
            Some(Ok(_)) => true,
            Some(Err((at, _))) => *at > stage,
            None => self.facts.is_some(),
        }
    }
}
