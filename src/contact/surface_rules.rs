//! Friction coefficients by the surfaces that touch.

/// A surface that may touch another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// That of a body or net, by its number: bodies first.
    Owner(usize),
    /// Those of all obstacles.
    Obstacles,
}

/// Friction coefficient of some surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionRule {
    /// The surfaces.
    pub surfaces: Vec<Surface>,
    /// The surfaces that they touch; `None` for all.
    pub others: Option<Vec<Surface>>,
    /// mu.
    pub coefficient: f64,
}

/// Friction coefficients of contacts, by the surfaces that touch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionTable {
    /// mu of surfaces without a rule.
    pub coefficient: f64,
    /// The rules.
    pub rules: Vec<FrictionRule>,
}

impl FrictionTable {
    /// mu between two surfaces: that of the first rule for both; otherwise the least of the rules for one of them; otherwise that
    /// of all.
    pub fn between(&self, one: Surface, other: Surface) -> f64 {
        let both = self.rules.iter().find(|rule| {
            let others = rule.others.as_deref().unwrap_or_default();
            let joins = |a, b| rule.surfaces.contains(a) && others.contains(b);
            joins(&one, &other) || joins(&other, &one)
        });
        if let Some(rule) = both {
            return rule.coefficient;
        }
        let single = self.rules.iter().filter(|rule| rule.others.is_none());
        let single = single.filter(|rule| rule.surfaces.contains(&one) || rule.surfaces.contains(&other));
        single.map(|rule| rule.coefficient).reduce(f64::min).unwrap_or(self.coefficient)
    }
}
