//! Registry of kinds. A kind in `registry!` can be written in a level file, appears in the menus and is covered by
//! the tests. A new kind needs its file, its `mod` line and one entry in its list.
//!
//! A program that uses the crate adds [own kinds](Own) of effects, integrators, meshes and so on.

use std::{any::Any, fmt};

/// A kind from outside the crate. It works like a listed one, but level files cannot hold it.
///
/// ```
/// use gingerbread::{integrators::{Class, FirstOrder, Integrator, IntegratorKind, Ode, Scheme, StepCounts, Workspace},
///     state::State};
///
/// /// Forward Euler for the positions of a toy.
/// #[derive(Clone, PartialEq)]
/// struct Euler;
///
/// impl Integrator for Euler {
///     fn title(&self) -> &'static str {
///         "My Euler"
///     }
///     fn about(&self) -> &'static str {
///         "x + h f(x)"
///     }
///     fn order(&self) -> u32 {
///         1
///     }
///     fn class(&self) -> Class {
///         Class::Explicit
///     }
///     fn scheme(&self) -> Scheme<'_> {
///         Scheme::First(self)
///     }
/// }
///
/// impl FirstOrder for Euler {
///     fn step(&self, system: &mut dyn Ode, state: &mut State, _: &mut Workspace, h: f64) -> StepCounts {
///         let mut rate = vec![0.0; state.x.len()];
///         system.rate(0.0, &state.x, &mut rate);
///         state.x.iter_mut().zip(&rate).for_each(|(x, rate)| *x += h * rate);
///         StepCounts::ONE
///     }
/// }
///
/// let kind = IntegratorKind::own("MyEuler", Euler);
/// assert_eq!((kind.name(), kind.kind().order()), ("MyEuler", 1));
/// assert!(ron::to_string(&kind).is_err(), "no file can hold it");
/// ```
pub struct Own<T: ?Sized + 'static> {
    /// Name in reports and tables.
    name: &'static str,
    kind: Box<dyn OwnKind<T>>,
}

/// What [`Own`] asks of a kind. Every type with the trait of a list has it, if it can be cloned and compared.
pub trait OwnKind<T: ?Sized + 'static>: Any + Send + Sync {
    /// The trait object of the kind.
    fn kind(&self) -> &T;

    /// The mutable trait object of the kind.
    fn kind_mut(&mut self) -> &mut T;

    /// A clone.
    fn boxed(&self) -> Box<dyn OwnKind<T>>;

    /// Whether another kind has the same type and equal parameters.
    fn is_equal(&self, other: &dyn Any) -> bool;
}

impl<T: ?Sized + 'static> Own<T> {
    /// From a kind, with its name in reports and tables.
    pub fn new(name: &'static str, kind: impl OwnKind<T>) -> Self {
        Self { name, kind: Box::new(kind) }
    }

    /// Name in reports and tables.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The trait object of the kind.
    pub fn kind(&self) -> &T {
        self.kind.kind()
    }

    /// The mutable trait object of the kind.
    pub fn kind_mut(&mut self) -> &mut T {
        self.kind.kind_mut()
    }
}

impl<T: ?Sized + 'static> Clone for Own<T> {
    fn clone(&self) -> Self {
        Self { name: self.name, kind: self.kind.boxed() }
    }
}

impl<T: ?Sized + 'static> fmt::Debug for Own<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

impl<T: ?Sized + 'static> PartialEq for Own<T> {
    fn eq(&self, other: &Self) -> bool {
        let other_kind: &dyn Any = &*other.kind;
        self.name == other.name && self.kind.is_equal(other_kind)
    }
}

/// Serialises no own kind: no file could be read again.
pub(crate) fn refuse<T: ?Sized, S: serde::Serializer>(own: &Own<T>, _: S) -> Result<S::Ok, S::Error> {
    Err(serde::ser::Error::custom(format_args!("a level file cannot hold {}, which is made in code", own.name)))
}

/// Declares the enum of all kinds of a module.
///
/// `enum Name: dyn Trait { Kind(Type), .. }` holds the parameters of a kind. `kind()` and `kind_mut()` return the
/// trait object.
/// `enum Name: static Trait(Parameters) via Visitor { Kind(Type), .. }` only names a kind. `visit` builds `Type` from
/// the parameters and passes it to a visitor that the compiler specialises: one `match` for a whole mesh.
macro_rules! registry {
    ($(#[$attribute:meta])* $vis:vis enum $Name:ident: dyn $Trait:ident { $($Kind:ident($Type:ty)),+ $(,)? }) => {
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        $vis enum $Name {
            $(#[doc = concat!("See [`", stringify!($Type), "`].")] $Kind($Type),)+
            /// A kind from outside the crate.
            #[serde(skip_deserializing, serialize_with = "crate::registry::refuse")]
            Own($crate::registry::Own<dyn $Trait>),
        }

        impl<K: $Trait + Clone + PartialEq + Send + Sync + 'static> $crate::registry::OwnKind<dyn $Trait> for K {
            fn kind(&self) -> &(dyn $Trait + 'static) {
                self
            }

            fn kind_mut(&mut self) -> &mut (dyn $Trait + 'static) {
                self
            }

            fn boxed(&self) -> Box<dyn $crate::registry::OwnKind<dyn $Trait>> {
                Box::new(self.clone())
            }

            fn is_equal(&self, other: &dyn std::any::Any) -> bool {
                other.downcast_ref::<K>() == Some(self)
            }
        }

        impl $Name {
            /// A kind from outside the crate, with its name in reports and tables.
            $vis fn own(name: &'static str, kind: impl $crate::registry::OwnKind<dyn $Trait>) -> Self {
                Self::Own($crate::registry::Own::new(name, kind))
            }

            /// Every kind, with its default parameters, in the order of the menus.
            $vis fn all() -> Vec<Self> {
                vec![$(Self::$Kind(<$Type>::default())),+]
            }

            /// The name used in level files.
            $vis const fn name(&self) -> &'static str {
                match self { $(Self::$Kind(_) => stringify!($Kind),)+ Self::Own(own) => own.name() }
            }

            /// The trait object of the kind.
            $vis fn kind(&self) -> &(dyn $Trait + 'static) {
                match self { $(Self::$Kind(kind) => kind,)+ Self::Own(own) => own.kind() }
            }

            /// The mutable trait object of the kind.
            $vis fn kind_mut(&mut self) -> &mut (dyn $Trait + 'static) {
                match self { $(Self::$Kind(kind) => kind,)+ Self::Own(own) => own.kind_mut() }
            }
        }

        $(impl From<$Type> for $Name {
            fn from(kind: $Type) -> Self {
                Self::$Kind(kind)
            }
        })+
    };
    ($(#[$attribute:meta])* $vis:vis enum $Name:ident: static $Trait:ident($Parameters:ty) via $Visitor:ident
        { $($Kind:ident($Type:ty)),+ $(,)? }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        $vis enum $Name {
            $(#[doc = concat!("See [`", stringify!($Type), "`].")] $Kind),+
        }

        impl $Name {
            /// Every kind, in the order of the menus.
            $vis const ALL: &'static [Self] = &[$(Self::$Kind),+];

            /// The name used in level files.
            $vis const fn name(self) -> &'static str {
                match self { $(Self::$Kind => stringify!($Kind)),+ }
            }

            /// Runs the visitor on the kind built from its parameters.
            $vis fn visit<V: $Visitor>(self, parameters: $Parameters, visitor: V) -> V::Output {
                match self { $(Self::$Kind => visitor.visit(&<$Type>::new(parameters))),+ }
            }
        }
    };
}

pub(crate) use registry;
