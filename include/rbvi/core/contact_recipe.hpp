// What a scene says of one contact interface before there is a mesh. Recipes are made by the kinds
// of contact (contact/*/): obstacle(), two_bodies(), by_multipliers(), by_nitsche(), ...
#pragma once

#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace rbvi {

struct FullMu;
struct Scene;
struct InterfaceMesh;
class ContactInterface;

enum class FrictionLaw { none, tresca, coulomb };

enum class Formulation {
  mixed,  ///< multipliers: B u <= G, lambda >= 0
  nitsche ///< Nitsche's method: residual and tangent on the cells beside the interface
};

/// A curve that turns by more, in radians, has a corner there: between the turn of a circle of 12
/// edges, 30 degrees, and that of a chamfer, 45.
inline constexpr double sharp_turn = 36 * std::numbers::pi / 180;

/// The part of a mesh that an interface is posed on.
struct InterfaceEntities {
  enum class Kind {
    cells,       ///< of the region parts[0]
    facets,      ///< of the boundaries `parts`: edges in the plane, triangles in space
    cells_beside ///< the boundary parts[0]: cells with an edge on it (2D)
  };
  Kind kind = Kind::cells;
  std::vector<std::string> parts;
  std::vector<int> components{}; ///< of the displacement that its kernels see; empty: all
  bool snapped = false;          ///< Scene::curves: middles of edges are on them
};

/// A function of the parameters alone that an interface or its law is made of.
struct ContactCoefficient {
  std::string name; ///< "coefficient of friction"
  std::function<double(const FullMu &mu)> value;
};

struct ContactRecipe {
  InterfaceEntities entities;
  Formulation formulation = Formulation::mixed;
  FrictionLaw friction = FrictionLaw::none;
  /// Vertex quadrature: every row of B has one node, so that the constraint is a bound there.
  bool nodal = false;
  /// B and G are sums over the entities, of a pattern that does not depend on mu: empirical
  /// interpolation over mu separates them. Otherwise they are evaluated at each mu, online too.
  bool separable = true;
  /// B and G depend on the displacement as well (large deformations): the problem is solved by
  /// Kacanov's or Newton's iteration. Not separable.
  bool follows_state = false;
  /// A reduced model keeps a multiplier at every node, unless asked otherwise: the law is exact.
  bool keeps_nodes = false;
  double push = 0; ///< of an obstacle: where it pushes a membrane, 1, upwards, or -1
  /// Refused where they are not finite, before anything is solved (core/validity.hpp).
  std::vector<ContactCoefficient> coefficients{};
  /// `scene` must outlive the interface. Throws bad_input where the mesh does not suit it.
  std::function<std::unique_ptr<ContactInterface>(const Scene &scene, InterfaceMesh mesh)> make;
  std::string name{}; ///< of its entry in the case; "": it has none (contact_name)
};

/// "contact 'floor' on 'foot'", or "contact on 'foot'": for messages.
std::string described(const ContactRecipe &contact);

} // namespace rbvi
