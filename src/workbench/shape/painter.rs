//! The thread that paints, so that the screen's never waits for a picture.

use std::{
    sync::{Arc, mpsc},
    thread,
};

use super::{Picture, Scene, Solid, Style, portrait};
use crate::mesh::Mesh;

/// Surfaces that are kept ready: as many as a list shows small pictures of, and some more.
const READY: usize = 48;

/// Paints scenes one after the other. Dropping it lets the thread end after the picture it is at.
#[derive(Debug)]
pub struct Painter {
    scenes: mpsc::Sender<Vec<Scene>>,
}

impl Painter {
    /// Starts the thread. `tell` is called on it with each scene that was painted.
    ///
    /// # Errors
    /// When the system has no thread to give.
    pub fn start(tell: impl Fn(Scene, Arc<Picture>) + Send + 'static) -> std::io::Result<Self> {
        let (scenes, inbox) = mpsc::channel();
        thread::Builder::new().name("painter".into()).spawn(move || work(&inbox, &tell))?;
        Ok(Self { scenes })
    }

    /// Wants these scenes painted, and none of those that were wanted before.
    pub fn paint(&self, scenes: Vec<Scene>) {
        // Without its thread there are no pictures; everything else goes on.
        let _ = self.scenes.send(scenes);
    }
}

fn work(inbox: &mpsc::Receiver<Vec<Scene>>, tell: &dyn Fn(Scene, Arc<Picture>)) {
    let mut ready: Vec<(Arc<Mesh>, Solid)> = Vec::new();
    let mut wanted: Vec<Scene> = Vec::new();
    loop {
        let news = if wanted.is_empty() { inbox.recv().ok() } else { inbox.try_recv().ok() };
        if let Some(newest) = news.map(|first| inbox.try_iter().last().unwrap_or(first)) {
            wanted = newest;
        } else if wanted.is_empty() {
            return;
        }
        if wanted.is_empty() {
            continue;
        }
        let scene = wanted.remove(0);
        let at = ready.iter().position(|(mesh, _)| Arc::ptr_eq(mesh, &scene.mesh)).unwrap_or_else(|| {
            if ready.len() == READY {
                ready.remove(0);
            }
            ready.push((Arc::clone(&scene.mesh), Solid::new(&scene.mesh)));
            ready.len() - 1
        });
        let values = scene.function.as_ref().map(|function| function.values.as_slice());
        let mut picture = Picture::paint(&ready[at].1, scene.camera, scene.pixels(), scene.style.aspect(), values);
        if scene.style == Style::Pixels {
            picture.png = portrait::clear_png(&picture, values.is_some()).map(Arc::new);
        }
        tell(scene, Arc::new(picture));
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{super::Camera, *};

    fn scene(model: usize, yaw: i32) -> Scene {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        let camera = Camera { yaw, ..Camera::default() };
        Scene { model, mesh: Arc::new(mesh), function: None, camera, cells: (4, 2), style: Style::Dots }
    }

    #[test]
    fn the_last_scene_wanted_is_painted() {
        let (sender, pictures) = mpsc::channel();
        let painter = Painter::start(move |scene, picture| {
            let _ = sender.send((scene, picture));
        })
        .unwrap();
        for yaw in 0..30 {
            painter.paint(vec![scene(0, yaw), scene(1, yaw)]);
        }
        loop {
            let (scene, picture) = pictures.recv_timeout(Duration::from_secs(30)).unwrap();
            assert_eq!((picture.width, picture.height), (8, 8));
            if (scene.model, scene.camera.yaw) == (1, 29) {
                break;
            }
        }
        drop(painter);
        assert!(pictures.recv_timeout(Duration::from_secs(30)).is_err(), "its thread has ended");
    }
}
