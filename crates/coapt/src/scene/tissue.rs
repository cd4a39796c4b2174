//! What leaflets are made of.

use serde::{Deserialize, Serialize};

/// A stress-strain law with its constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, tag = "law", rename_all = "kebab-case")]
pub enum Tissue {
    /// Isotropic network of edge springs, soft up to a transition strain and stiff beyond (paper 003).
    BilinearSprings {
        /// Modulus below the transition strain [MPa].
        #[serde(default = "default_pre_transition_modulus_mpa")]
        pre_transition_modulus_mpa: f64,
        /// Strain at which the collagen takes over [mm/mm]; 0.25 in paper 003.
        #[serde(default = "default_transition_strain")]
        transition_strain: f64,
        /// Modulus above the transition strain [MPa].
        #[serde(default = "default_post_transition_modulus_mpa")]
        post_transition_modulus_mpa: f64,
        /// Modulus in compression over the pre-transition modulus [1].
        #[serde(default = "default_compression_modulus_ratio")]
        compression_modulus_ratio: f64,
        /// Modulus in bending over the pre-transition modulus [1]; 0: the leaflets bend freely.
        #[serde(default = "default_bending_modulus_ratio")]
        bending_modulus_ratio: f64,
    },
    /// Edge springs with one law around the valve and another towards the margin. Between the two directions moduli and
    /// transition strains pass over as X(φ) = X₀ cos⁴φ + X₉₀ sin⁴φ + 2 √(X₀ X₉₀) sin²φ cos²φ (our choice: a fibre network's form).
    AnisotropicSprings {
        /// Along the annulus.
        circumferential: SpringBranches,
        /// From the annulus to the margin.
        radial: SpringBranches,
        /// Modulus in compression over the pre-transition modulus [1].
        #[serde(default = "default_compression_modulus_ratio")]
        compression_modulus_ratio: f64,
        /// Modulus in bending [MPa]; 0: the leaflet bends freely.
        #[serde(default = "default_bending_modulus_mpa")]
        bending_modulus_mpa: f64,
    },
    /// Membrane, linear in Green's strain under plane stress (paper 002: 0.4 MPa anterior, 0.1 MPa posterior).
    StVenantKirchhoff {
        /// Young's modulus [MPa].
        modulus_mpa: f64,
        /// Poisson's ratio [1]; 0.5 in paper 002.
        #[serde(default = "default_poisson_ratio")]
        poisson_ratio: f64,
        /// What happens under compression.
        #[serde(default)]
        wrinkling: Wrinkling,
        /// Modulus in bending [MPa]; 0: the leaflet bends freely.
        #[serde(default = "default_bending_modulus_mpa")]
        bending_modulus_mpa: f64,
    },
    /// Membrane of isotropic tissue that stiffens exponentially, w = C₀/2 (I₁ − 3) + C₁/2 (exp(C₂ (I₁ − 3)²) − 1); with
    /// C₁ = 0 neo-Hookean of shear modulus C₀. Tricuspid leaflets of Mathur 2022: C₀ 0.001 MPa, C₁ 0.000124 to 0.000191 MPa,
    /// C₂ 4.6 to 17.8.
    Exponential {
        /// C₀ [MPa].
        c0_mpa: f64,
        /// C₁ [MPa].
        c1_mpa: f64,
        /// C₂ [1].
        c2: f64,
        /// Twice the inverse of the bulk modulus, D in (J − 1)² / D [1/MPa]; 0: incompressible.
        #[serde(default)]
        compressibility_per_mpa: f64,
        /// What happens under compression.
        #[serde(default)]
        wrinkling: Wrinkling,
        /// Modulus in bending [MPa]; 0: the leaflet bends freely.
        #[serde(default = "default_bending_modulus_mpa")]
        bending_modulus_mpa: f64,
    },
    /// Membrane of incompressible tissue with fibres around the valve, w = c₀ (exp(c₁ (I₁ − 3)² + c₂ (α − 1)⁴) − 1), α the
    /// stretch of the fibres (May-Newman & Yin 1998; its constants, as often quoted and not checked by us: anterior c₀
    /// 0.399 kPa, c₁ 4.325, c₂ 1446.5; posterior 0.414 kPa, 4.848, 305.4).
    MayNewman {
        /// c₀ [MPa].
        c0_mpa: f64,
        /// c₁ [1].
        c1: f64,
        /// c₂ [1].
        c2: f64,
        /// What happens under compression.
        #[serde(default)]
        wrinkling: Wrinkling,
        /// Modulus in bending [MPa]; 0: the leaflet bends freely.
        #[serde(default = "default_bending_modulus_mpa")]
        bending_modulus_mpa: f64,
    },
}

/// The two branches of a bilinear spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpringBranches {
    /// Modulus below the transition strain [MPa].
    pub pre_transition_modulus_mpa: f64,
    /// Strain at which the collagen takes over [mm/mm].
    pub transition_strain: f64,
    /// Modulus above it [MPa].
    pub post_transition_modulus_mpa: f64,
}

impl SpringBranches {
    /// The branches in a direction between two, given the square of the cosine to the first: X(φ) = (√X₀ cos²φ + √X₉₀ sin²φ)²,
    /// which is the form of [`Tissue::AnisotropicSprings`].
    pub fn between(first: &Self, second: &Self, cosine_squared: f64) -> Self {
        let blend = |of: fn(&Self) -> f64| {
            (of(first).sqrt() * cosine_squared + of(second).sqrt() * (1.0 - cosine_squared)).powi(2)
        };
        Self {
            pre_transition_modulus_mpa: blend(|branches| branches.pre_transition_modulus_mpa),
            transition_strain: blend(|branches| branches.transition_strain),
            post_transition_modulus_mpa: blend(|branches| branches.post_transition_modulus_mpa),
        }
    }
}

/// What a membrane does under compression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Wrinkling {
    /// It resists as its law says; the mesh shows the wrinkles that it can.
    #[default]
    Resolved,
    /// It wrinkles finer than the mesh and carries tension only.
    TensionField,
}

/// Excised anterior leaflet, pre-transitional 0.06-0.09 MPa (Krishnamurthy 2009, abstract). Paper 003 prints
/// no moduli; 0.08 lies within the measured range.
fn default_pre_transition_modulus_mpa() -> f64 {
    0.08
}

/// Paper 003, section 2.2.
fn default_transition_strain() -> f64 {
    0.25
}

/// Excised anterior leaflet, post-transitional 2-9 MPa (Krishnamurthy 2009, abstract); 4 is our choice in it.
fn default_post_transition_modulus_mpa() -> f64 {
    4.0
}

/// Our choice: the soft branch goes on into compression. Much softer and the margin crumples at mesh scale.
pub fn default_compression_modulus_ratio() -> f64 {
    1.0
}

/// 0.48 MPa with the default modulus. Porcine aortic leaflets in flexure: 0.49 MPa with their curvature, 0.70 against it
/// (Merryman 2006, J Biomech 39:88); nothing was found for mitral ones. Paper 003 has no bending; without it nothing but
/// the mesh says how narrow a fold is, and folds at the commissures and on an open margin come out otherwise from every
/// start. At 1, a plate of the soft modulus, they still do; at 20 the leaflets no longer lie down on each other
/// (coaptation of the healthy valve falls by 40 %).
fn default_bending_modulus_ratio() -> f64 {
    6.0
}

/// As the springs have by default: 6 times 0.08 MPa.
pub fn default_bending_modulus_mpa() -> f64 {
    default_bending_modulus_ratio() * default_pre_transition_modulus_mpa()
}

/// Incompressible (paper 002).
pub fn default_poisson_ratio() -> f64 {
    0.5
}

impl Tissue {
    /// The law as scenes name it.
    pub fn law_name(&self) -> &'static str {
        match self {
            Self::BilinearSprings { .. } => "bilinear-springs",
            Self::AnisotropicSprings { .. } => "anisotropic-springs",
            Self::StVenantKirchhoff { .. } => "st-venant-kirchhoff",
            Self::Exponential { .. } => "exponential",
            Self::MayNewman { .. } => "may-newman",
        }
    }

    /// What happens under compression; nothing is said of springs, which have a modulus in compression.
    pub fn wrinkling(&self) -> Option<Wrinkling> {
        match *self {
            Self::BilinearSprings { .. } | Self::AnisotropicSprings { .. } => None,
            Self::StVenantKirchhoff { wrinkling, .. }
            | Self::Exponential { wrinkling, .. }
            | Self::MayNewman { wrinkling, .. } => Some(wrinkling),
        }
    }
}

impl Default for Tissue {
    fn default() -> Self {
        Self::BilinearSprings {
            pre_transition_modulus_mpa: default_pre_transition_modulus_mpa(),
            transition_strain: default_transition_strain(),
            post_transition_modulus_mpa: default_post_transition_modulus_mpa(),
            compression_modulus_ratio: default_compression_modulus_ratio(),
            bending_modulus_ratio: default_bending_modulus_ratio(),
        }
    }
}
