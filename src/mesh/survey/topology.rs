//! How triangles hang together.

use super::{Defect, DefectKind, Spot};
use crate::{
    mesh::by_vertex::ByVertex,
    watch::{Pulse, Unwatched},
};

/// What the topology of the sound triangles is.
pub(super) struct Topology {
    pub components: usize,
    pub boundary_edges: usize,
    pub boundary_loops: usize,
    pub euler: i64,
    pub genus: Option<u64>,
    pub oriented: bool,
}

/// One triangle's side.
#[derive(Clone, Copy)]
struct Side {
    /// The vertices, the smaller one first.
    edge: (u32, u32),
    /// 3 × place of the triangle + the corner at which the side begins.
    corner: u32,
    /// True where the triangle runs from the smaller vertex to the greater.
    ascending: bool,
}

/// Sets that are joined (union by size, path halving).
struct Sets {
    parent: Vec<u32>,
    size: Vec<u32>,
}

impl Sets {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), size: vec![1; count] }
    }

    fn find(&mut self, mut item: u32) -> u32 {
        while self.parent[item as usize] != item {
            let above = self.parent[self.parent[item as usize] as usize];
            self.parent[item as usize] = above;
            item = above;
        }
        item
    }

    fn join(&mut self, a: u32, b: u32) {
        let (mut a, mut b) = (self.find(a), self.find(b));
        if a == b {
            return;
        }
        if self.size[a as usize] < self.size[b as usize] {
            std::mem::swap(&mut a, &mut b);
        }
        self.parent[b as usize] = a;
        self.size[a as usize] += self.size[b as usize];
    }
}

/// Records defects of edges, vertices and components. `sound` are triangles of three different vertices below
/// `vertices`, with their numbers.
pub(super) fn look(vertices: usize, sound: &[(u32, [u32; 3])], defects: &mut Vec<Defect>) -> Topology {
    let sides = sides(vertices, sound);
    let groups: Vec<&[Side]> = sides.chunk_by(|a, b| a.edge == b.edge).collect();
    let spot = |group: &&[Side]| Spot::Edge(group[0].edge.0, group[0].edge.1);

    let crowded = groups.iter().filter(|group| group.len() > 2);
    let crowded_edges = crowded.clone().count();
    Defect::record(DefectKind::NonManifoldEdge, crowded.map(spot), defects);

    let boundary = || groups.iter().filter(|group| group.len() == 1);
    let boundary_edges = boundary().count();
    let boundary_loops = pieces(vertices, boundary().map(|group| group[0].edge));
    Defect::record(DefectKind::Boundary, boundary().map(spot), defects);
    if let Some(defect) = defects.last_mut().filter(|defect| defect.kind == DefectKind::Boundary) {
        defect.loops = boundary_loops;
    }

    let touching = touching_vertices(vertices, sound, &groups);
    let touches = !touching.is_empty();
    Defect::record(DefectKind::NonManifoldVertex, touching.into_iter().map(Spot::Vertex), defects);

    let same_way = || groups.iter().filter(|group| matches!(group, [a, b] if a.ascending == b.ascending));
    let oriented = same_way().next().is_none();
    let orientable = oriented || orientable(sound.len(), &groups);
    let kind = if orientable { DefectKind::Inconsistent } else { DefectKind::NonOrientable };
    Defect::record(kind, same_way().map(spot), defects);

    let firsts = components(vertices, sound);
    let components = firsts.len();
    if components > 1 {
        Defect::record(DefectKind::Components, firsts.into_iter().map(Spot::Triangle), defects);
    }

    let mut used = vec![false; vertices];
    for vertex in sound.iter().flat_map(|(_, triangle)| triangle) {
        used[*vertex as usize] = true;
    }
    let used = used.into_iter().filter(|used| *used).count();
    let euler = used as i64 - groups.len() as i64 + sound.len() as i64;
    let closed = components > 0 && boundary_edges == 0 && crowded_edges == 0 && !touches;
    let genus = (closed && orientable).then(|| u64::try_from(components as i64 - euler / 2).ok()).flatten();
    Topology { components, boundary_edges, boundary_loops, euler, genus, oriented }
}

/// All sides, ascending by edge and then by triangle: counted out by their smaller vertex, which leaves a few each to
/// sort.
fn sides(vertices: usize, sound: &[(u32, [u32; 3])]) -> Vec<Side> {
    let all = || {
        (0..).zip(sound).flat_map(|(place, &(_, [a, b, c]))| {
            [(0, a, b), (1, b, c), (2, c, a)].map(|(i, from, to)| {
                let ascending = from < to;
                let edge = if ascending { (from, to) } else { (to, from) };
                (edge.0, Side { edge, corner: 3 * place + i, ascending })
            })
        })
    };
    // Nothing stops it.
    let Ok(mut sides) = ByVertex::new(vertices, all, &Pulse::new(&Unwatched)) else { return Vec::new() };
    for of_vertex in sides.lists() {
        of_vertex.sort_unstable_by_key(|side| (side.edge.1, side.corner));
    }
    sides.into_items()
}

/// Into how many connected pieces edges fall.
fn pieces(vertices: usize, edges: impl Iterator<Item = (u32, u32)>) -> usize {
    let mut sets = Sets::new(vertices);
    let mut ends = Vec::new();
    for (a, b) in edges {
        sets.join(a, b);
        ends.push(a);
    }
    let mut roots: Vec<u32> = ends.into_iter().map(|vertex| sets.find(vertex)).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

/// The first triangle of each component.
fn components(vertices: usize, sound: &[(u32, [u32; 3])]) -> Vec<u32> {
    let mut sets = Sets::new(vertices);
    for &(_, [a, b, c]) in sound {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut seen = vec![false; vertices];
    sound
        .iter()
        .filter(|(_, triangle)| !std::mem::replace(&mut seen[sets.find(triangle[0]) as usize], true))
        .map(|&(number, _)| number)
        .collect()
}

/// Vertices whose triangles fall into more than one fan: going round the vertex from triangle to triangle across shared
/// edges does not reach them all.
fn touching_vertices(vertices: usize, sound: &[(u32, [u32; 3])], groups: &[&[Side]]) -> Vec<u32> {
    // A set holds the corners, at one vertex, of triangles that share edges there.
    let mut fans = Sets::new(3 * sound.len());
    // The corners of a side's triangle at the side's smaller and greater vertex.
    let ends = |side: &Side| {
        let next = if side.corner % 3 == 2 { side.corner - 2 } else { side.corner + 1 };
        if side.ascending { (side.corner, next) } else { (next, side.corner) }
    };
    for group in groups {
        for [a, b] in group.array_windows() {
            let ((a, c), (b, d)) = (ends(a), ends(b));
            fans.join(a, b);
            fans.join(c, d);
        }
    }
    let mut fan = vec![u32::MAX; vertices];
    let mut touching = vec![false; vertices];
    for (place, (_, triangle)) in (0..).zip(sound) {
        for (i, &vertex) in (0..).zip(triangle) {
            let root = fans.find(3 * place + i);
            let first = &mut fan[vertex as usize];
            if *first == u32::MAX {
                *first = root;
            } else if *first != root {
                touching[vertex as usize] = true;
            }
        }
    }
    (0..).zip(touching).filter(|&(_, touching)| touching).map(|(vertex, _)| vertex).collect()
}

/// Whether triangles can be turned so that every edge of two triangles is run through in both directions.
fn orientable(triangles: usize, groups: &[&[Side]]) -> bool {
    // Item 2t stands for triangle t as it is, 2t + 1 for it turned: an edge joins what must hold together.
    let mut sets = Sets::new(2 * triangles);
    for group in groups {
        if let [a, b] = group {
            let (s, t) = (a.corner / 3, b.corner / 3);
            let turn = u32::from(a.ascending == b.ascending);
            sets.join(2 * s, 2 * t + turn);
            sets.join(2 * s + 1, 2 * t + (1 - turn));
        }
    }
    (0..triangles as u32).all(|triangle| sets.find(2 * triangle) != sets.find(2 * triangle + 1))
}
