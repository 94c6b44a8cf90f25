//! A hemisphere cut into cells.

use super::disc::DiscBasis;
use super::rings::RingBasis;
use crate::scene::BasisChoice;
use glam::{DVec2, DVec3};

/// Cells of a hemisphere. They index the (x, y) projection of a unit vector.
#[derive(Clone, Debug, PartialEq)]
pub enum Basis {
    /// Cells of the concentric map, all of one projected solid angle.
    Disc(DiscBasis),
    /// Rings around the normal.
    Rings(RingBasis),
}

impl Basis {
    /// The cells that go by a name.
    pub fn new(choice: BasisChoice) -> Basis {
        match choice {
            BasisChoice::Disc(n) => Basis::Disc(DiscBasis { n }),
            BasisChoice::Klems => Basis::Rings(RingBasis::klems()),
            BasisChoice::Polar { rings, sectors } => Basis::Rings(RingBasis::polar(rings, sectors)),
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        match self {
            Basis::Disc(disc) => disc.cells(),
            Basis::Rings(rings) => rings.cells(),
        }
    }

    /// Projected solid angle of a cell in sr; those of all cells add up to π.
    pub fn projected_solid_angle(&self, cell: usize) -> f64 {
        match self {
            Basis::Disc(disc) => disc.projected_solid_angle(),
            Basis::Rings(rings) => rings.projected_solid_angle(cell),
        }
    }

    /// The place of the projection (x, y) in cells: edges of cells lie at whole numbers.
    pub fn place(&self, projection: DVec2) -> DVec2 {
        match self {
            Basis::Disc(disc) => disc.place(projection),
            Basis::Rings(rings) => rings.place(projection),
        }
    }

    /// The cell that holds a direction, by its projection (x, y).
    pub fn cell_of(&self, projection: DVec2) -> usize {
        match self {
            Basis::Disc(disc) => disc.cell_of(projection),
            Basis::Rings(rings) => rings.cell_of(projection),
        }
    }

    /// The unit vector, z ≥ 0, at a place of [0, 1]² inside a cell: places that are uniform give directions that are
    /// uniform in projected solid angle.
    pub fn direction(&self, cell: usize, place: DVec2) -> DVec3 {
        match self {
            Basis::Disc(disc) => disc.direction(cell, place),
            Basis::Rings(rings) => rings.direction(cell, place),
        }
    }

    /// The unit vector in the middle of a cell.
    pub fn centre(&self, cell: usize) -> DVec3 {
        self.direction(cell, DVec2::splat(0.5))
    }

    /// For each cell the cell of a coarser basis that holds all of it; none when a cell lies in several.
    pub fn inside(&self, coarse: &Basis) -> Option<Vec<usize>> {
        let nested = match (self, coarse) {
            (Basis::Disc(fine), Basis::Disc(coarse)) => fine.n.is_multiple_of(coarse.n),
            (Basis::Rings(fine), Basis::Rings(coarse)) => nested(fine, coarse),
            _ => coarse.cells() == 1,
        };
        nested.then(|| (0..self.cells()).map(|cell| coarse.cell_of(self.centre(cell).truncate())).collect())
    }
}

/// Whether edges of the coarse rings and sectors are edges of the fine ones.
fn nested(fine: &RingBasis, coarse: &RingBasis) -> bool {
    if fine == coarse {
        return true;
    }
    let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let within = |outer: &super::rings::Ring, inner: &super::rings::Ring| {
        // Sectors that are cut evenly share their edges only when both begin on the axis.
        outer.sectors == 1 || (outer.shift == 0.0 && inner.shift == 0.0 && inner.sectors.is_multiple_of(outer.sectors))
    };
    coarse.rings().iter().all(|outer| {
        let inside = |ring: &&super::rings::Ring| {
            let middle = (ring.edges[0] + ring.edges[1]) / 2.0;
            (outer.edges[0]..outer.edges[1]).contains(&middle)
        };
        let parts: Vec<_> = fine.rings().iter().filter(inside).collect();
        let ends = parts.first().zip(parts.last());
        ends.is_some_and(|(first, last)| same(first.edges[0], outer.edges[0]) && same(last.edges[1], outer.edges[1]))
            && parts.iter().all(|inner| within(outer, inner))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_that_are_cut_say_so() {
        let polar = |rings, sectors| Basis::new(BasisChoice::Polar { rings, sectors });
        let disc = |n| Basis::new(BasisChoice::Disc(n));
        let klems = Basis::new(BasisChoice::Klems);
        assert_eq!(polar(4, 6).inside(&polar(2, 3)).map(|cells| cells[6 + 5]), Some(2));
        assert_eq!(polar(4, 6).inside(&polar(2, 3)).map(|cells| cells[12]), Some(3));
        assert_eq!(klems.inside(&klems).map(|cells| cells[144]), Some(144));
        assert_eq!(disc(4).inside(&disc(2)).map(|cells| cells[15]), Some(3));
        for (fine, coarse) in
            [(disc(3), disc(2)), (polar(3, 6), polar(2, 3)), (polar(4, 6), polar(2, 4)), (klems.clone(), polar(1, 3))]
        {
            assert!(fine.inside(&coarse).is_none(), "{fine:?} in {coarse:?}");
        }
        assert!(polar(18, 1).inside(&klems).is_none() && klems.inside(&polar(1, 1)).is_some());
    }
}
