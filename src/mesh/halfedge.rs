//! A closed triangle surface that can be re-meshed in place: corners, twins, and the three moves on an edge.
//!
//! Triangle f owns the half-edges 3f, 3f + 1, 3f + 2; each starts at `start` and has its `twin` in the neighbour.
//! All moves keep the surface a closed oriented 2-manifold of the same genus: they refuse what would not. Edges can be
//! marked; a mark goes where its edge goes.

use super::vector::V3;

/// Marks a removed half-edge or vertex.
const GONE: u32 = u32::MAX;

/// The surface and the positions of its vertices.
#[derive(Debug, Clone)]
pub struct HalfEdges {
    pub points: Vec<V3>,
    start: Vec<u32>,
    twin: Vec<u32>,
    /// Whether the half-edge's edge is marked; both of its half-edges say so.
    marked: Vec<bool>,
    /// A half-edge that starts at the vertex.
    out: Vec<u32>,
    live: usize,
}

/// The next half-edge in the triangle.
pub const fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The previous half-edge in the triangle.
pub const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// The connectivity of a closed oriented manifold surface, no edge marked; none when an edge lacks its other side.
    pub fn new(points: Vec<V3>, triangles: &[[u32; 3]]) -> Option<Self> {
        let start = triangles.as_flattened().to_vec();
        let mut out = vec![GONE; points.len()];
        // The half-edges from each vertex: those of `a` are `fan[first[a]..first[a + 1]]`.
        let mut first = vec![0_u32; points.len() + 1];
        for (h, &a) in (0_u32..).zip(&start) {
            out[a as usize] = h;
            first[a as usize + 1] += 1;
        }
        for a in 0..points.len() {
            first[a + 1] += first[a];
        }
        let mut free = first.clone();
        let mut fan = vec![0_u32; start.len()];
        for (h, &a) in (0_u32..).zip(&start) {
            fan[free[a as usize] as usize] = h;
            free[a as usize] += 1;
        }
        let mut twin = vec![GONE; start.len()];
        for (h, &a) in (0_u32..).zip(&start) {
            let b = start[next(h) as usize] as usize;
            let mut back = fan[first[b] as usize..first[b + 1] as usize].iter();
            let &t = back.find(|&&t| start[next(t) as usize] == a && twin[t as usize] == GONE)?;
            twin[t as usize] = h;
        }
        let live = out.iter().filter(|&&h| h != GONE).count();
        let marked = vec![false; start.len()];
        Some(Self { points, start, twin, marked, out, live })
    }

    /// The number of vertices left.
    pub const fn vertex_count(&self) -> usize {
        self.live
    }

    /// One more than the highest vertex index, removed ones included.
    pub fn vertex_slots(&self) -> u32 {
        self.out.len() as u32
    }

    /// One more than the highest half-edge index, removed ones included.
    pub fn slots(&self) -> u32 {
        self.start.len() as u32
    }

    pub fn has_vertex(&self, a: u32) -> bool {
        self.out[a as usize] != GONE
    }

    pub fn has(&self, h: u32) -> bool {
        self.start[h as usize] != GONE
    }

    pub fn start(&self, h: u32) -> u32 {
        self.start[h as usize]
    }

    pub fn end(&self, h: u32) -> u32 {
        self.start[next(h) as usize]
    }

    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// Whether the edge is marked.
    pub fn is_marked(&self, h: u32) -> bool {
        self.marked[h as usize]
    }

    /// Marks the edge, or takes its mark away.
    pub fn mark(&mut self, h: u32, marked: bool) {
        let t = self.twin(h);
        self.marked[h as usize] = marked;
        self.marked[t as usize] = marked;
    }

    /// The vertex across the edge, in the triangle of `h`.
    pub fn apex(&self, h: u32) -> u32 {
        self.start[prev(h) as usize]
    }

    /// The corners of the triangle whose first half-edge is `h`.
    pub fn corners(&self, h: u32) -> [u32; 3] {
        let h = h as usize;
        [self.start[h], self.start[h + 1], self.start[h + 2]]
    }

    pub fn point(&self, a: u32) -> V3 {
        self.points[a as usize]
    }

    pub fn length(&self, h: u32) -> f64 {
        (self.point(self.end(h)) - self.point(self.start(h))).norm()
    }

    /// The half-edges that start at `a`, in turn around it.
    pub fn around(&self, a: u32) -> impl Iterator<Item = u32> {
        let first = self.out[a as usize];
        let mut at = (first != GONE).then_some(first);
        std::iter::from_fn(move || {
            let h = at?;
            let after = self.twin[prev(h) as usize];
            at = (after != first).then_some(after);
            Some(h)
        })
    }

    /// The neighbours of `a`.
    pub fn neighbours(&self, a: u32) -> impl Iterator<Item = u32> {
        self.around(a).map(|h| self.end(h))
    }

    pub fn degree(&self, a: u32) -> usize {
        self.around(a).count()
    }

    /// The half-edges one per edge: those with the lower index.
    pub fn is_edge(&self, h: u32) -> bool {
        self.has(h) && h < self.twin(h)
    }

    /// The triangles left, as corners.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.start.as_chunks::<3>().0.iter().copied().filter(|t| t[0] != GONE)
    }

    /// Makes two half-edges one edge, which is marked if one of them was.
    fn join(&mut self, h: u32, t: u32) {
        self.twin[h as usize] = t;
        self.twin[t as usize] = h;
        let marked = self.marked[h as usize] || self.marked[t as usize];
        self.marked[h as usize] = marked;
        self.marked[t as usize] = marked;
    }

    /// Puts a vertex at `at` on the edge of `h`, and gives its index.
    pub fn split(&mut self, h: u32, at: V3) -> u32 {
        let t = self.twin(h);
        let (b, c, d) = (self.end(h), self.apex(h), self.apex(t));
        let m = self.points.len() as u32;
        self.points.push(at);
        self.live += 1;
        let (bc, ad) = (next(h), next(t));
        let (beyond_bc, beyond_ad) = (self.twin(bc), self.twin(ad));
        // h's triangle (a b c) becomes (a m c) and a new (m b c); t's (b a d) becomes (b m d) and a new (m a d).
        let a = self.start(h);
        let f = self.start.len() as u32;
        let g = f + 3;
        self.start.extend([m, b, c, m, a, d]);
        self.twin.extend([GONE; 6]);
        self.marked.extend([false; 6]);
        self.start[next(h) as usize] = m;
        self.start[next(t) as usize] = m;
        // The marks of what was (b c) and (a d) move out with the edges.
        for (inner, outer) in [(bc, f + 1), (ad, g + 1)] {
            self.marked[outer as usize] = std::mem::take(&mut self.marked[inner as usize]);
        }
        self.join(h, g);
        self.join(t, f);
        self.join(bc, f + 2);
        self.join(ad, g + 2);
        self.join(f + 1, beyond_bc);
        self.join(g + 1, beyond_ad);
        self.out.push(f);
        self.out[a as usize] = h;
        self.out[b as usize] = t;
        self.out[c as usize] = f + 2;
        self.out[d as usize] = g + 2;
        m
    }

    /// Whether [`HalfEdges::flip`] keeps the surface a manifold with no vertex of fewer than four neighbours.
    pub fn can_flip(&self, h: u32) -> bool {
        let t = self.twin(h);
        let (c, d) = (self.apex(h), self.apex(t));
        c != d
            && self.degree(self.start(h)) > 4
            && self.degree(self.end(h)) > 4
            && self.neighbours(c).all(|other| other != d)
    }

    /// Replaces the edge, which is not marked, by the other diagonal of its two triangles; `h` and its twin are no
    /// longer that edge.
    pub fn flip(&mut self, h: u32) {
        let t = self.twin(h);
        let (bc, ca, ad, db) = (next(h), prev(h), next(t), prev(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.start(ca), self.start(db));
        let (beyond_bc, beyond_ad) = (self.twin(bc), self.twin(ad));
        // (a b c), (b a d) → (a d c), (b c d).
        self.start[bc as usize] = d;
        self.start[ad as usize] = c;
        self.marked[bc as usize] = false;
        self.marked[ad as usize] = false;
        self.join(h, beyond_ad);
        self.join(t, beyond_bc);
        self.join(bc, ad);
        self.out[a as usize] = h;
        self.out[b as usize] = t;
        self.out[c as usize] = ca;
        self.out[d as usize] = db;
    }

    /// Whether the ends of the edge have no common neighbour but the two across it, so that the surface stays a
    /// manifold when they become one vertex; and none of the two across falls below four neighbours.
    pub fn can_collapse(&self, h: u32) -> bool {
        self.can_collapse_to(h, 4)
    }

    /// The same with so many neighbours, at least 3.
    pub fn can_collapse_to(&self, h: u32, least: usize) -> bool {
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        let more = |x: u32| self.around(x).nth(least).is_some();
        if c == d || self.live <= 8 || !more(c) || !more(d) {
            return false;
        }
        // Most vertices have fewer neighbours than this.
        let (mut ring, mut seen) = ([GONE; 16], 0);
        for x in self.neighbours(b) {
            if let Some(slot) = ring.get_mut(seen) {
                *slot = x;
            }
            seen += 1;
        }
        let is_beside_b =
            |x: u32| if seen <= ring.len() { ring.contains(&x) } else { self.neighbours(b).any(|y| y == x) };
        let (mut common, mut degree) = (0, 0);
        for x in self.neighbours(a) {
            common += usize::from(is_beside_b(x));
            degree += 1;
        }
        common == 2 && degree + seen >= 4 + least
    }

    /// Makes the edge's start one with its end, which moves to `at`.
    pub fn collapse(&mut self, h: u32, at: V3) {
        let t = self.twin(h);
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.apex(h), self.apex(t));
        let mut spoke = h;
        loop {
            self.start[spoke as usize] = b;
            spoke = self.twin[prev(spoke) as usize];
            if spoke == h {
                break;
            }
        }
        let (bc, ca, ad, db) = (self.twin(next(h)), self.twin(prev(h)), self.twin(next(t)), self.twin(prev(t)));
        self.join(bc, ca);
        self.join(ad, db);
        for gone in [h, next(h), prev(h), t, next(t), prev(t)] {
            self.start[gone as usize] = GONE;
        }
        // Of each joined pair, the one that starts where it is named.
        for (vertex, pair) in [(b, ca), (c, bc), (d, ad)] {
            self.out[vertex as usize] = if self.start(pair) == vertex { pair } else { self.twin(pair) };
        }
        self.out[a as usize] = GONE;
        self.points[b as usize] = at;
        self.live -= 1;
    }

    /// The vertices and triangles left, in their order, renumbered; without the vertices from `but` and their
    /// triangles.
    pub fn parts(&self, but: std::ops::Range<u32>) -> (Vec<V3>, Vec<[u32; 3]>) {
        let mut renamed = vec![GONE; self.out.len()];
        let mut points = Vec::with_capacity(self.live);
        for a in (0..self.vertex_slots()).filter(|&a| self.has_vertex(a) && !but.contains(&a)) {
            renamed[a as usize] = points.len() as u32;
            points.push(self.point(a));
        }
        let triangles = self.triangles().map(|t| t.map(|a| renamed[a as usize]));
        (points, triangles.filter(|t| !t.contains(&GONE)).collect())
    }

    /// Number of components and sum of their genera.
    pub fn topology(&self) -> (usize, i64) {
        let mut seen = vec![false; self.out.len()];
        let (mut components, mut half_edges) = (0, 0_i64);
        for first in 0..self.vertex_slots() {
            if !self.has_vertex(first) || std::mem::replace(&mut seen[first as usize], true) {
                continue;
            }
            components += 1;
            let mut open = vec![first];
            while let Some(a) = open.pop() {
                for b in self.neighbours(a) {
                    half_edges += 1;
                    if !std::mem::replace(&mut seen[b as usize], true) {
                        open.push(b);
                    }
                }
            }
        }
        // V − E + F = 2 (components − genus), and 3 F = 2 E.
        let euler = self.live as i64 - half_edges / 6;
        (components, components as i64 - euler / 2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::v;
    use super::*;

    /// A torus of 12 × 8 vertices, each square cut in two.
    fn ring() -> HalfEdges {
        let (m, n) = (12_u32, 8_u32);
        let at = |i: u32, j: u32| (i % m) * n + j % n;
        let mut points = Vec::new();
        let mut triangles = Vec::new();
        for i in 0..m {
            for j in 0..n {
                let (u, w) = (f64::from(i) / f64::from(m), f64::from(j) / f64::from(n));
                let [(su, cu), (sw, cw)] = [u, w].map(|turn| (turn * std::f64::consts::TAU).sin_cos());
                points.push(v((1.0 + 0.4 * cw) * cu, (1.0 + 0.4 * cw) * su, 0.4 * sw));
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        HalfEdges::new(points, &triangles).unwrap()
    }

    /// Every twin is mutual and opposite, every fan closes and holds all of the vertex's half-edges.
    fn assert_sound(mesh: &HalfEdges) {
        let mut fans = vec![0; mesh.vertex_slots() as usize];
        for h in (0..mesh.slots()).filter(|&h| mesh.has(h)) {
            let t = mesh.twin(h);
            assert_eq!(mesh.twin(t), h);
            assert_eq!((mesh.start(t), mesh.end(t)), (mesh.end(h), mesh.start(h)));
            assert_eq!(mesh.is_marked(h), mesh.is_marked(t));
            assert!(mesh.has_vertex(mesh.start(h)));
            fans[mesh.start(h) as usize] += 1;
        }
        for a in (0..mesh.vertex_slots()).filter(|&a| mesh.has_vertex(a)) {
            assert!(mesh.around(a).all(|h| mesh.start(h) == a));
            assert_eq!(mesh.degree(a), fans[a as usize]);
        }
    }

    /// Splits, flips and collapses edges at will.
    fn shake(mesh: &mut HalfEdges) {
        let mut state = 12_345_u64;
        let mut below = |n: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % u64::from(n)) as u32
        };
        for round in 0..4000 {
            let h = below(mesh.slots());
            if !mesh.has(h) {
                continue;
            }
            let middle = mesh.point(mesh.start(h)).lerp(mesh.point(mesh.end(h)), 0.5);
            match below(4) {
                0 if round < 2000 => {
                    mesh.split(h, middle);
                }
                1 if mesh.can_flip(h) => mesh.flip(h),
                _ if mesh.can_collapse(h) => mesh.collapse(h, middle),
                _ => {}
            }
        }
    }

    #[test]
    fn random_moves_keep_a_torus() {
        let mut mesh = ring();
        shake(&mut mesh);
        assert_sound(&mesh);
        assert_eq!(mesh.topology(), (1, 1));
        let (points, triangles) = mesh.parts(0..0);
        assert_eq!(points.len(), mesh.vertex_count());
        let again = HalfEdges::new(points, &triangles).unwrap();
        assert_sound(&again);
        assert_eq!(again.topology(), (1, 1));
    }

    #[test]
    fn marks_go_where_their_edges_go() {
        let mut mesh = ring();
        // The circle j = 0 around the hole.
        let circle = |a: u32| a.is_multiple_of(8);
        for h in (0..mesh.slots()).filter(|&h| circle(mesh.start(h)) && circle(mesh.end(h))).collect::<Vec<_>>() {
            mesh.mark(h, true);
        }
        for _ in 0..3 {
            for h in 0..mesh.slots() {
                let middle = mesh.point(mesh.start(h)).lerp(mesh.point(mesh.end(h)), 0.5);
                match h % 5 {
                    0 => _ = mesh.split(h, middle),
                    1 if !mesh.is_marked(h) && mesh.can_flip(h) => mesh.flip(h),
                    _ => {}
                }
            }
        }
        assert_sound(&mesh);
        let marked: Vec<u32> = (0..mesh.slots()).filter(|&h| mesh.is_marked(h)).collect();
        assert!(marked.len() > 24, "some were split: {}", marked.len());
        // Still one closed line, each vertex with its two neighbours on it.
        for &h in &marked {
            assert_eq!(mesh.around(mesh.start(h)).filter(|&o| mesh.is_marked(o)).count(), 2);
        }
        let mut at = marked[0];
        let mut length = 0;
        while length == 0 || at != marked[0] {
            let back = mesh.twin(at);
            at = mesh.around(mesh.end(at)).find(|&o| mesh.is_marked(o) && o != back).unwrap();
            length += 1;
        }
        assert_eq!(2 * length, marked.len());
    }

    #[test]
    fn open_surfaces_are_refused() {
        assert!(HalfEdges::new(vec![V3::default(); 3], &[[0, 1, 2]]).is_none());
        // Each edge has another, but in the same direction.
        assert!(HalfEdges::new(vec![V3::default(); 3], &[[0, 1, 2], [0, 1, 2]]).is_none());
    }

    #[test]
    fn some_vertices_can_be_left_out() {
        let mesh = ring();
        let (points, triangles) = mesh.parts(5..6);
        assert_eq!((points.len(), triangles.len()), (95, 186));
    }
}
