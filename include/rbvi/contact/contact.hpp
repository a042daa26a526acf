// The interfaces of a problem, one after the other: the multipliers of interface i are the rows
// [first_row[i], first_row[i + 1]) of B. On a rank or in the online program.
#pragma once

#include "rbvi/contact/interface.hpp"

namespace rbvi {

struct Contact {
  std::vector<std::unique_ptr<ContactInterface>> interfaces;
  std::vector<std::string> names; ///< contact_name of each
  std::vector<Index> first_row;   ///< interfaces + 1
  SparseMatrix stacked_gram;      ///< of W, with several interfaces

  Index dual_size() const { return first_row.back(); }
  /// All normal multipliers, over the interfaces.
  Index nodes() const;
  /// Gram matrix of W, dual x dual.
  const SparseMatrix &w_product() const {
    return interfaces.size() == 1 ? interfaces.front()->dual().gram : stacked_gram;
  }
};

/// `meshes`: of each contact of the scene, with the columns of the problem. `scene` must outlive
/// it. Throws bad_input where a mesh does not suit its recipe, and for Nitsche's method beside
/// multipliers.
Contact make_contact(const Scene &scene, std::vector<InterfaceMesh> meshes);

/// The operators of all interfaces together.
void assemble(const Contact &contact, const FullMu &mu, const ContactState &state,
              ContactOperators &operators);
/// The same at rest, but perhaps for B, for less work.
void assemble_gaps(const Contact &contact, const FullMu &mu, ContactOperators &operators);
/// The same from those of each interface.
void stack(const Contact &contact, const std::vector<ContactOperators> &all,
           ContactOperators &operators);
/// weights, nodal_b and nodal_gap alone, the weights where `lambda` is not zero (empty: all).
void assemble_nodal(const Contact &contact, const FullMu &mu, const ContactState &state,
                    const Vector &lambda, ContactOperators &operators);

/// Contacts that share vertices of cells of degree 1, one of them with friction: multipliers there
/// may ask more than the displacement of a vertex can meet, and how that ends. Empty: none do.
std::string overdetermined(const Contact &contact);

/// Whether some interface follows the state; whether all that do have a curvature.
bool follows_state(const Contact &contact);
bool has_curvature(const Contact &contact);
/// That of all interfaces; those that follow no state have none.
Curvature curvature(const Contact &contact, const FullMu &mu, const ContactState &state,
                    const Vector &lambda);
/// The interface whose nodes are all of them, if it is nodal; else null.
const ContactInterface *nodal_interface(const Contact &contact);
/// The state in which the bodies are where the map puts them: minus the motion of the scene, at the
/// columns of B.
Vector undeformed(const Contact &contact, const Scene &scene, const FullMu &mu);

/// The laws of all multipliers at mu. Throws failure for a bound that is negative.
NodeLaws laws_at(const Contact &contact, const FullMu &mu);

/// Why an iteration with these multipliers failed: `reason`, unless contact has come to the end of
/// its boundary, which is then said first. `operators`: of a state.
std::string failure_at(const Contact &contact, const FullMu &mu, const ContactOperators &operators,
                       const Vector &lambda, const std::string &reason);

/// What adhesion pulls with, beside the multipliers, which count from it (contact/friction.hpp).
struct Pull {
  double pressure = 0;     ///< of the pull, >= 0; 0: there is none
  double normal_force = 0; ///< <= 0
  Point force{};           ///< on the body; of a membrane zero
};
Pull pull_of(ContactInterface &interface, const FullMu &mu, const ContactState &state);

/// ContactInterface::fields, not whole, with the pressure that there is: less the pull.
Grid contact_fields(ContactInterface &interface, const FullMu &mu, const Vector &u,
                    const Vector &lambda);

/// Fills the outputs of contact: with several interfaces those that are sums or maxima over them.
/// See ContactInterface::outputs.
void contact_outputs(const Contact &contact, const FullMu &mu, const ContactOperators &operators,
                     const Vector &lambda, double least, Outputs &outputs);

/// Whose multiplier a row of B is.
struct DualRow {
  std::size_t interface;
  Index node; ///< of the interface
  bool normal;
};
DualRow dual_row(const Contact &contact, Index row);
/// "floor: ", the contact of a row, before what is said of it.
std::string said_of(const Contact &contact, Index row);

/// The multipliers of each dual node, of all interfaces: nodes x dim, normal and tangential (zero
/// without friction).
Matrix by_node(const Contact &contact, const Vector &lambda);

/// Reference points of the dual nodes.
std::vector<Point> dual_points(const Contact &contact);

/// The middle of each entity, with the material there.
std::vector<MaterialPoint> material_points(const Contact &contact);

} // namespace rbvi
