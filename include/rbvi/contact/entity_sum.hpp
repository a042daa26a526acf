// Interfaces whose B and g are sums over their entities, of a pattern that does not depend on mu. A
// kind gives what one entity adds; the rest is here: assembly, and (mor, model) empirical
// interpolation from a few entities.
#pragma once

#include "rbvi/contact/interface.hpp"

#include <span>

namespace rbvi {

/// What one entity adds. Rows: normal multipliers of its vertices, then their tangential ones;
/// columns: node * components + component.
struct EntityValues {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 12, 30>;
  Block b;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1> g;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1> weights; ///< of its vertices
};

class EntitySum : public ContactInterface {
public:
  /// Sets b and g of `values`, which has its shape, or no columns of b. `entity`: its vertices,
  /// reference and mapped, and the state, where there is one.
  virtual void integrate(const FullMu &mu, const Cell &entity, EntityValues &values) const = 0;
  /// The same, less b times the values imposed on the entity in g.
  void integrate_beside_imposed(const FullMu &mu, const Cell &entity, EntityValues &values) const;
  /// Sets the weights.
  virtual void weigh(const FullMu &mu, const Cell &entity, EntityValues &values) const = 0;

  void assemble(const FullMu &mu, const ContactState &state, const WantedNodes &wanted,
                ContactOperators &operators) override {
    sum(mu, state, wanted, true, operators);
  }
  void assemble_gaps(const FullMu &mu, ContactOperators &operators) override {
    sum(mu, {}, {}, !imposed_by_.empty(), operators);
  }
  void assemble_nodal(const FullMu &mu, const ContactState &state, const Vector &lambda,
                      ContactOperators &operators) override;
  bool can_be_split() const override { return true; }
  Vector nodal_forces(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  const EntitySum *entity_sum() const override { return this; }

  int entity_dim() const { return entity_dim_; }
  /// Zero values of the shape of an entity.
  EntityValues shape() const;
  /// The dual rows of an entity, in the order of EntityValues; -1 where there is none. A row can
  /// stand there twice, at a vertex and at a fixed one beside it.
  std::span<const int> rows_of(Index entity) const;
  /// Its columns of B, -1 where there is none.
  std::vector<Index> columns_of(Index entity) const;
  /// Its reference vertices, and by what its dofs are imposed; valid as long as the interface.
  Cell reference_entity(Index entity) const;
  /// Sets the displacement of an entity to that of a state, imposed values included, which it keeps
  /// in `values`; leaves it null at rest.
  void set_displacement(const FullMu &mu, Index entity, const ContactState &state, Cell &cell,
                        std::vector<double> &values) const;

  std::vector<std::array<double, 2>> held_gaps(const FullMu &mu) const override;

protected:
  EntitySum(const Scene &scene, InterfaceMesh mesh, int entity_dim);
  /// The dual functions are the hats of the first `vertices` nodes of the mesh that can move. The
  /// hat of a fixed one, which has no displacement to act on, is added to that of the nearest
  /// vertex beside it that can, or to where that of a fixed one beside it is added, so that the
  /// functions sum to 1 still; with vertex quadrature
  /// (`lumped`), where a function acts on its own vertex alone, it is left out. `gram`: of all
  /// hats. Throws bad_input where no vertex can move.
  void set_dual(Index vertices, int components, bool lumped, const SparseMatrix &gram);
  /// Per vertex: its dual function, -1 where there is none.
  const std::vector<Index> &dual_of_vertex() const { return dual_of_vertex_; }

private:
  void sum(const FullMu &mu, const ContactState &state, const WantedNodes &wanted, bool with_b,
           ContactOperators &operators);
  bool can_move(int node) const;
  std::vector<Index> dual_functions(Index vertices, bool lumped) const;
  void set_rows();
  Index rows() const { return (entity_dim_ + 1) * dual_.components; }
  /// The entities on which the function of a wanted node does not vanish; empty: all.
  std::vector<bool> entities_at(const WantedNodes &wanted) const;
  void set_pattern(const WantedNodes &wanted);
  /// Of the vertices of these entities; of a boundary of all, as the others stay where they are.
  std::vector<Point> mapped_vertices(const FullMu &mu, const std::vector<bool> &entities) const;
  /// visit(entity, cell), mapped, for each of these (empty: all). Throws failure for one that is
  /// inverted.
  template <class Visit>
  void visit_entities(const FullMu &mu, const std::vector<Point> &mapped,
                      const std::vector<bool> &entities, Visit &&visit) const;
  void check_sizes(const FullMu &mu, const std::vector<Point> &mapped) const;
  /// Throws bad_input where a node cannot move along its normal.
  void check_partly_fixed(const WantedNodes &wanted, const ContactOperators &operators) const;
  void add_weights(const FullMu &mu, Index entity, const Cell &cell, EntityValues &values,
                   Vector &weights) const;

  int entity_dim_;
  std::vector<Index> dual_of_vertex_;
  std::vector<int> rows_;       ///< of each entity
  std::vector<int> imposed_by_; ///< of the dofs of each entity; empty: nothing is imposed
  SparseMatrix pattern_;        ///< of b, zero values; made by the first assemble
  WantedNodes pattern_wanted_;  ///< the rows that it has
  std::vector<int> position_;   ///< per value of their kernels: where in b it is added, -1 nowhere
};

} // namespace rbvi
