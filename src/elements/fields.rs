use super::Triangles;
use crate::materials::{Material, Visitor};
use nalgebra::Matrix2;

/// What shape triangles are in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// Least det F; infinite if there are none.
    pub least: f64,
    /// How many have det F <= 0.
    pub inverted: usize,
    /// How many are beyond where the model's formula is used to the letter.
    pub continued: usize,
}

/// What triangles can be coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// Plain gingerbread.
    #[default]
    None,
    /// Elastic energy density psi [J/m²].
    EnergyDensity,
    /// Von Mises equivalent of the Cauchy stress [Pa].
    VonMises,
    /// J = det F: area over rest area.
    Volume,
}

impl Field {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 4] = [Self::None, Self::EnergyDensity, Self::VonMises, Self::Volume];

    /// Name in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::None => "Gingerbread",
            Self::EnergyDensity => "Energy density",
            Self::VonMises => "Von Mises stress",
            Self::Volume => "Area ratio J",
        }
    }

    /// Unit symbol.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::None | Self::Volume => "",
            Self::EnergyDensity => "J/m²",
            Self::VonMises => "Pa",
        }
    }
}

impl Triangles {
    /// What shape the triangles are in; in the same sweep adds one value a triangle to `values`, in their order, but nothing for
    /// [`Field::None`].
    pub fn survey(&self, field: Field, x: &[f64], values: &mut Vec<f64>) -> Survey {
        self.model().visit(self.lame(), Values { of: self, field, x, out: values })
    }

    /// det F of each triangle.
    pub fn volume_ratios(&self, x: &[f64]) -> impl Iterator<Item = f64> {
        self.gradients(x).map(|(f, _)| f.determinant())
    }
}

struct Values<'a> {
    of: &'a Triangles,
    field: Field,
    x: &'a [f64],
    out: &'a mut Vec<f64>,
}

impl Visitor for Values<'_> {
    type Output = Survey;
    fn visit<M: Material>(self, material: &M) -> Survey {
        let Values { of, field, x, out } = self;
        let plane_stress = of.plane_stress();
        let mut found = Survey { least: f64::INFINITY, inverted: 0, continued: 0 };
        let gradients = of.gradients(x).map(|(f, _)| {
            let j = f.determinant();
            found.least = found.least.min(j);
            found.inverted += usize::from(j <= 0.0);
            found.continued += usize::from(material.is_continued(&f));
            (f, j)
        });
        match field {
            Field::None => gradients.for_each(drop),
            Field::Volume => out.extend(gradients.map(|(_, j)| j)),
            Field::EnergyDensity => out.extend(gradients.map(|(f, _)| material.energy(&f))),
            Field::VonMises => out.extend(gradients.map(|(f, _)| von_mises(material, &f, plane_stress))),
        }
        found
    }
}

/// Von Mises equivalent of the Cauchy stress `sigma = P Fᵀ / J` [Pa]:
/// `sqrt(((sx - sy)² + (sy - sz)² + (sz - sx)²)/2 + 3 sxy²)`, where `sz = P33/J` in plane strain and 0 in plane stress.
pub fn von_mises<M: Material>(material: &M, f: &Matrix2<f64>, plane_stress: bool) -> f64 {
    let j = f.determinant();
    let sigma = material.stress(f) * f.transpose() / j;
    let thickness = if plane_stress { 0.0 } else { material.thickness_stress(f) / j };
    let (x, y, xy) = (sigma.m11, sigma.m22, 0.5 * (sigma.m12 + sigma.m21));
    let differences = (x - y) * (x - y) + (y - thickness) * (y - thickness) + (thickness - x) * (thickness - x);
    (0.5 * differences + 3.0 * xy * xy).sqrt()
}
