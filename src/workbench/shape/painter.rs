//! The thread that paints, so that the screen's never waits for a picture.

use std::{
    sync::{Arc, mpsc},
    thread,
    time::{Duration, Instant},
};

use super::{Picture, Scene, Solid, Style, packed};
use crate::mesh::Mesh;

/// Surfaces that are kept ready: as many as a list shows small pictures of, and some more.
const READY: usize = 48;

/// A shape that was seen from elsewhere so short a time ago is being turned.
const TURNING: Duration = Duration::from_millis(400);
/// So long after the last turn it is painted finely.
const REST: Duration = Duration::from_millis(200);
/// The most pixels and bytes of a picture for a terminal that takes pictures: of one that stays, and of one while the
/// shape turns. The latter is a tenth of a second on a line of two megabits a second.
const FINE: (usize, usize) = (1 << 20, 160 << 10);
const ROUGH: (usize, usize) = (1 << 17, 24 << 10);
/// No pixel is painted larger, whatever that costs.
const COARSEST: usize = 16;

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

/// What the thread has at hand.
#[derive(Default)]
struct Easel {
    /// Surfaces, the newest last.
    ready: Vec<(Arc<Mesh>, Solid)>,
    /// What was painted last for a terminal that takes pictures, and when.
    last: Option<(Scene, Instant)>,
}

fn work(inbox: &mpsc::Receiver<Vec<Scene>>, tell: &dyn Fn(Scene, Arc<Picture>)) {
    let mut easel = Easel::default();
    let mut wanted: Vec<Scene> = Vec::new();
    // A scene that was painted roughly, to be painted finely once nothing else is wanted.
    let mut rough: Option<Scene> = None;
    loop {
        let news = match (wanted.is_empty(), &rough) {
            (false, _) => inbox.try_recv().ok(),
            (true, None) => match inbox.recv() {
                Ok(news) => Some(news),
                Err(_) => return,
            },
            (true, Some(_)) => match inbox.recv_timeout(REST) {
                Ok(news) => Some(news),
                Err(mpsc::RecvTimeoutError::Timeout) => None,
                Err(mpsc::RecvTimeoutError::Disconnected) => return,
            },
        };
        if let Some(first) = news {
            wanted = inbox.try_iter().last().unwrap_or(first);
            rough = None;
        }
        if !wanted.is_empty() {
            let scene = wanted.remove(0);
            let turning = easel.turning(&scene);
            let picture = easel.paint(&scene, turning);
            if turning {
                rough = Some(scene.clone());
            }
            tell(scene, Arc::new(picture));
        } else if let Some(scene) = rough.take() {
            let picture = easel.paint(&scene, false);
            tell(scene, Arc::new(picture));
        }
    }
}

impl Easel {
    /// Whether this is one picture of many: the shape was seen from elsewhere a moment ago.
    fn turning(&self, scene: &Scene) -> bool {
        scene.style == Style::Pixels
            && self.last.as_ref().is_some_and(|(last, at)| {
                last.model == scene.model && last.camera != scene.camera && at.elapsed() < TURNING
            })
    }

    /// Paints a scene; roughly while it turns.
    fn paint(&mut self, scene: &Scene, rough: bool) -> Picture {
        let at = self.ready.iter().position(|(mesh, _)| Arc::ptr_eq(mesh, &scene.mesh)).unwrap_or_else(|| {
            if self.ready.len() == READY {
                self.ready.remove(0);
            }
            self.ready.push((Arc::clone(&scene.mesh), Solid::new(&scene.mesh)));
            self.ready.len() - 1
        });
        let values = scene.function.as_ref().map(|function| function.values.as_slice());
        let (across, down) = scene.pixels();
        let paint = |scale: usize| {
            let size = (across.div_ceil(scale), down.div_ceil(scale));
            Picture::paint(&self.ready[at].1, scene.camera, size, scene.style.aspect(), values)
        };
        if scene.style != Style::Pixels {
            return paint(1);
        }
        let (pixels, bytes) = if rough { ROUGH } else { FINE };
        let mut scale = 1;
        while across.div_ceil(scale) * down.div_ceil(scale) > pixels {
            scale += 1;
        }
        loop {
            let mut picture = paint(scale);
            let packed = packed::pack(&picture, values.is_some(), scene.raster, scene.cells, (scale, rough));
            if scale >= COARSEST || packed.as_ref().is_none_or(|packed| packed.bytes() <= bytes) {
                self.last = Some((scene.clone(), Instant::now()));
                picture.packed = packed.map(Arc::new);
                return picture;
            }
            scale += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{
        super::{Camera, Packing, Raster},
        *,
    };

    fn scene(model: usize, yaw: i32) -> Scene {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        let camera = Camera { yaw, ..Camera::default() };
        Scene {
            model,
            mesh: Arc::new(mesh),
            function: None,
            camera,
            cells: (4, 2),
            style: Style::Dots,
            raster: Raster::default(),
        }
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

    #[test]
    fn a_shape_that_turns_is_painted_roughly_and_finely_once_it_rests() {
        let (sender, pictures) = mpsc::channel();
        let painter = Painter::start(move |scene: Scene, picture| {
            let _ = sender.send((scene.camera.yaw, picture));
        })
        .unwrap();
        let raster = Raster { packing: Packing::Sixels { colours: 256 }, cell: (10, 20) };
        let first = Scene { cells: (80, 40), style: Style::Pixels, raster, ..scene(0, 0) };
        let seen = |yaw: i32| Scene { camera: Camera { yaw, ..first.camera }, ..first.clone() };
        let next = || pictures.recv_timeout(Duration::from_secs(30)).unwrap();
        let packed = |picture: &Picture| picture.packed.as_ref().unwrap().bytes();
        painter.paint(vec![seen(0)]);
        let (_, still) = next();
        assert_eq!((still.width, still.height), (800, 800));
        painter.paint(vec![seen(1)]);
        let (yaw, rough) = next();
        assert!(yaw == 1 && rough.width < 400 && packed(&rough) <= ROUGH.1, "{}", rough.width);
        let (yaw, fine) = next();
        assert!(yaw == 1 && fine.width == 800 && packed(&fine) > packed(&rough));
        // What else is wanted comes first.
        painter.paint(vec![seen(3), Scene { model: 1, style: Style::Dots, ..seen(3) }]);
        let painted: Vec<_> = (0..3).map(|_| next().1.packed.is_some()).collect();
        assert_eq!(painted, [true, false, true]);
        // What is no longer wanted is not painted again.
        painter.paint(vec![seen(2)]);
        assert!(next().1.width < 400);
        painter.paint(Vec::new());
        assert!(pictures.recv_timeout(REST * 3).is_err());
    }

    #[test]
    fn no_picture_has_more_bytes_than_the_line_is_given() {
        let mesh = crate::mesh::synth::generate(&crate::mesh::synth::Options::default(), 0, 0).unwrap();
        let values = Arc::new(mesh.vertices().iter().map(|vertex| (40.0 * vertex[0]).sin()).collect());
        let function = Some(super::super::Function { index: 3, values });
        let raster = Raster { packing: Packing::Sixels { colours: 256 }, cell: (12, 26) };
        let scene =
            Scene { mesh: Arc::new(mesh), function, cells: (200, 54), style: Style::Pixels, raster, ..scene(0, 30) };
        for (rough, (pixels, bytes)) in [(false, FINE), (true, ROUGH)] {
            let picture = Easel::default().paint(&scene, rough);
            let packed = picture.packed.unwrap();
            assert!(picture.width * picture.height <= pixels && packed.bytes() <= bytes, "{}", packed.bytes());
        }
    }
}
