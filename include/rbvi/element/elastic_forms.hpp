// Cell kernels of linear elasticity, as Forms: local dof = node * dim + component, degree 1 or 2.
// One kernel serves 2D (plane strain; plane stress with a lambda of its own) and 3D.
// Niakh (2022): (3.1), (3.2), (3.9), (3.10), (4.6)-(4.8).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Bounds of Young's modulus, as wide as round-off allows, and of Poisson's ratio, short of
/// incompressible bodies; elements of degree 1 lock before that (core/locking.hpp).
constexpr Range young_range{1e-6, 1e15}, poisson_range{-0.99, 0.4999};
/// Bounds of a coefficient of friction: above, solutions need not be unique.
constexpr Range friction_range{0, 5};

/// lambda = E nu / ((1 + nu) (1 - 2 nu)), shear = E / (2 (1 + nu)). `young` is E (a pressure),
/// `poisson` is nu. Throws bad_input unless E > 0 and -1 < nu < 1/2.
Lame lame(double young, double poisson);

/// int sigma(u) : eps(v) over the mapped cells, dim components (2.45)-(2.47), exact. Throws
/// bad_input for a degree other than 1 and 2.
Form elasticity(const std::string &region, const Lame &material, int degree = 1);

/// Elasticity with a material that is constant on each cell: `material(mu, centre)`, the centre
/// that of the reference cell.
Form elasticity(const std::string &region, const std::function<Material> &material, int degree);

/// lame() at each point, or that of a thin plate (plane stress), whose lambda is 2 lambda shear /
/// (lambda + 2 shear).
std::function<Material> isotropic(const std::function<PointValue> &young,
                                  const std::function<PointValue> &poisson, bool plane_stress);

/// Of Lame's constants; `plane_stress` as above. Throws bad_input where asked unless the shear
/// modulus and 3 lambda + 2 shear are positive.
std::function<Material> of_lame(const std::function<PointValue> &lambda,
                                const std::function<PointValue> &shear, bool plane_stress);

/// What a strain that is the same in all directions makes of stress where nothing moves: 3 lambda +
/// 2 shear; in plane stress, in its lambda, 2 lambda + 2 shear.
double swelling_modulus(const Lame &material, bool plane_stress);

/// Whether a material is one of isotropic() or of_lame() in plane stress: sigma_zz is 0 there.
bool is_plane_stress(const std::function<Material> &material);

/// One constant alone, `factor`; the other is 0.
std::function<Material> lambda_alone(const std::function<PointValue> &factor);
std::function<Material> shear_alone(const std::function<PointValue> &factor);

/// The same constants of a Young's modulus 1.
std::function<Coefficient> lame_lambda(const std::function<Coefficient> &poisson,
                                       bool plane_stress = false);
std::function<Coefficient> lame_shear(const std::function<Coefficient> &poisson);

/// int modulus strain div v, div in space: the load of a strain without stress, such as a thermal
/// one, in triangles or (dim 3) tetrahedra. `modulus` at the middle of a cell of the mesh, as
/// materials are; `strain` at its points. Exact where the strain is of degree 4 (axisymmetric: 3)
/// less that of v. Throws bad_input for a degree other than 1 and 2.
Form strain_load(const std::string &region, const std::function<PointValue> &modulus,
                 const std::function<PointValue> &strain, int dim, int degree, bool axisymmetric);

} // namespace rbvi
