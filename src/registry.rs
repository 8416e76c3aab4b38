//! Registry of kinds. A kind in `registry!` can be written in a level file, appears in the menus and is covered by
//! the tests.
//! A new kind needs its file, its `mod` line and one entry here.

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
            $(#[doc = concat!("See [`", stringify!($Type), "`].")] $Kind($Type)),+
        }

        impl $Name {
            /// Every kind, with its default parameters, in the order of the menus.
            $vis fn all() -> Vec<Self> {
                vec![$(Self::$Kind(<$Type>::default())),+]
            }

            /// The name used in level files.
            $vis const fn name(&self) -> &'static str {
                match self { $(Self::$Kind(_) => stringify!($Kind)),+ }
            }

            /// The trait object of the kind.
            $vis fn kind(&self) -> &dyn $Trait {
                match self { $(Self::$Kind(kind) => kind),+ }
            }

            /// The mutable trait object of the kind.
            $vis fn kind_mut(&mut self) -> &mut dyn $Trait {
                match self { $(Self::$Kind(kind) => kind),+ }
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
