//! The nearest of many triangles: a tree of bounding boxes.

use super::nearest_of_triangle;
use crate::mesh::vector::V3;

/// Triangles in a leaf, at most.
const LEAF: usize = 4;

/// A box and what is in it: the boxes `first` and `first + 1`, or so many triangles from `first` on.
#[derive(Clone, Copy)]
struct Node {
    low: V3,
    high: V3,
    first: u32,
    triangles: u32,
}

/// The tree. Its root is the first node.
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// In the order of the leaves.
    triangles: Vec<[V3; 3]>,
}

impl Tree {
    pub(super) fn new(triangles: &[[V3; 3]]) -> Self {
        let mut order: Vec<(V3, u32)> =
            (0..).zip(triangles).map(|(at, [a, b, c])| ((*a + *b + *c) * (1.0 / 3.0), at)).collect();
        let root = Node { low: V3::default(), high: V3::default(), first: 0, triangles: triangles.len() as u32 };
        let mut nodes = vec![root];
        let mut at = 0;
        // Each node is cut once those before it are; the nodes from `at` on hold their triangles as a range of `order`.
        while at < nodes.len() {
            let Node { first, triangles: count, .. } = nodes[at];
            let range = first as usize..(first + count) as usize;
            let corners = order[range.clone()].iter().flat_map(|&(_, t)| triangles[t as usize]);
            let everywhere = V3 { x: f64::INFINITY, y: f64::INFINITY, z: f64::INFINITY };
            let (low, high) =
                corners.fold((everywhere, -everywhere), |(low, high), corner| (low.min(corner), high.max(corner)));
            nodes[at].low = low;
            nodes[at].high = high;
            if range.len() > LEAF {
                let size = high - low;
                let axis: fn(V3) -> f64 = if size.x >= size.y && size.x >= size.z {
                    |p| p.x
                } else if size.y >= size.z {
                    |p| p.y
                } else {
                    |p| p.z
                };
                let half = range.len() / 2;
                order[range]
                    .select_nth_unstable_by(half, |(p, i), (q, j)| axis(*p).total_cmp(&axis(*q)).then(i.cmp(j)));
                nodes[at].first = nodes.len() as u32;
                nodes[at].triangles = 0;
                let half = half as u32;
                nodes.push(Node { first, triangles: half, ..root });
                nodes.push(Node { first: first + half, triangles: count - half, ..root });
            }
            at += 1;
        }
        let triangles = order.into_iter().map(|(_, t)| triangles[t as usize]).collect();
        Self { nodes, triangles }
    }

    /// The squared distance of `p` from the nearest triangle, and its number; `guess` is one that may be near.
    pub(super) fn nearest(&self, p: V3, guess: u32) -> (f64, u32) {
        let distance2 = |t: u32| {
            let off = p - nearest_of_triangle(p, self.triangles[t as usize]).1;
            off.dot(off)
        };
        let mut best = (distance2(guess), guess);
        let mut open = [(0.0, 0_u32); 128];
        open[0] = (self.nodes[0].distance2(p), 0);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (least, at) = open[depth];
            if least >= best.0 {
                continue;
            }
            let node = self.nodes[at as usize];
            if node.triangles > 0 {
                for t in node.first..node.first + node.triangles {
                    let found = distance2(t);
                    if found < best.0 {
                        best = (found, t);
                    }
                }
                continue;
            }
            let mut children =
                [node.first, node.first + 1].map(|child| (self.nodes[child as usize].distance2(p), child));
            // The nearer one last, so that it is looked at first.
            if children[0].0 < children[1].0 {
                children.swap(0, 1);
            }
            for child in children.into_iter().filter(|child| child.0 < best.0) {
                open[depth] = child;
                depth += 1;
            }
        }
        best
    }
}

impl Node {
    fn distance2(&self, p: V3) -> f64 {
        let off = (self.low - p).max(p - self.high).max(V3::default());
        off.dot(off)
    }
}
