//! How the deliberate faults of a reference DUT are listed: a row each, with its name, the clause it violates, and what is
//! wrong in one sentence. One that is a reading of the tables may be called by that as well.

/// Makes an enum of such rows.
macro_rules! catalogue {
    ($(#[$about:meta])* pub enum $Mutant:ident {
        $($Variant:ident $name:literal $(or $alias:literal)?, $clause:literal: $wrong:literal)*
    }) => {
        $(#[$about])*
        #[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
        pub enum $Mutant {
            $(#[doc = $wrong] $Variant,)*
        }

        impl $Mutant {
            /// All of them, in the order of the catalogue.
            pub const ALL: &'static [$Mutant] = &[$($Mutant::$Variant,)*];

            /// The name used in addresses, `?mutant=NAME`.
            pub const fn name(self) -> &'static str {
                match self { $($Mutant::$Variant => $name,)* }
            }

            /// The clause it violates, equal in both editions unless it says otherwise.
            pub const fn clause(self) -> &'static str {
                match self { $($Mutant::$Variant => $clause,)* }
            }

            /// What is wrong, in one sentence.
            pub const fn about(self) -> &'static str {
                match self { $($Mutant::$Variant => $wrong,)* }
            }

            /// The reading it follows, where that is another name for it.
            pub const fn alias(self) -> Option<&'static str> {
                match self { $($Mutant::$Variant => [$(Some($alias),)? None][0],)* }
            }

            /// The mutant of this name, or of this alias.
            pub fn from_name(name: &str) -> Option<$Mutant> {
                $Mutant::ALL.iter().copied().find(|mutant| mutant.name() == name || mutant.alias() == Some(name))
            }
        }

        impl std::fmt::Display for $Mutant {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

pub(crate) use catalogue;
