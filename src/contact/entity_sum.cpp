#include "rbvi/contact/entity_sum.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/imposed.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Copies a pattern; where the target has it already, its values alone are set to zero.
void clear(const SparseMatrix &pattern, SparseMatrix &target) {
  if (target.rows() == pattern.rows() && target.nonZeros() == pattern.nonZeros())
    std::fill_n(target.valuePtr(), target.nonZeros(), 0.0);
  else
    target = pattern;
}

} // namespace

EntityValues EntitySum::shape() const {
  EntityValues values;
  values.b.setZero(rows(), mesh_.per_entity * mesh_.components);
  values.g.setZero(rows());
  values.weights.setZero(entity_dim_ + 1);
  return values;
}

EntitySum::EntitySum(const Scene &scene, InterfaceMesh interface_mesh, int entity_dim)
    : ContactInterface(scene, std::move(interface_mesh)), entity_dim_(entity_dim) {
  for (std::size_t i = 0; i < mesh_.entities.size() && !mesh_.imposed_by.empty(); ++i)
    for (int c = 0; c < mesh_.components; ++c)
      imposed_by_.push_back(
          mesh_.imposed_by[static_cast<std::size_t>(mesh_.entities[i] * mesh_.components + c)]);
}

void EntitySum::integrate_beside_imposed(const FullMu &mu, const Cell &entity,
                                         EntityValues &values) const {
  integrate(mu, entity, values);
  if (entity.imposed_by == nullptr) return;
  const std::vector<int> imposed_by(entity.imposed_by, entity.imposed_by + values.b.cols());
  const std::vector<Point> nodes = node_points(entity_dim_, mesh_.degree, entity);
  values.g -= values.b * imposed_values(scene_, mu, nodes, imposed_by);
}

std::vector<Index> EntitySum::rows_of(Index entity) const {
  const int *nodes = mesh_.nodes_of(entity);
  std::vector<Index> result(nodes, nodes + entity_dim_ + 1);
  const Index tangents = dual_.components - 1;
  for (int a = 0; a <= entity_dim_; ++a)
    for (Index k = 0; k < tangents; ++k)
      result.push_back(dual_.nodes() + nodes[a] * tangents + k);
  return result;
}

std::vector<Index> EntitySum::columns_of(Index entity) const {
  const int *nodes = mesh_.nodes_of(entity);
  std::vector<Index> result;
  for (int i = 0; i < mesh_.per_entity; ++i)
    for (int c = 0; c < mesh_.components; ++c)
      result.push_back(mesh_.dofs[static_cast<std::size_t>(nodes[i] * mesh_.components + c)]);
  return result;
}

Cell EntitySum::reference_entity(Index entity) const {
  Cell cell{entity_dim_, {}, {}};
  const int *nodes = mesh_.nodes_of(entity);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(entity_dim_); ++i)
    cell.reference[i] = mesh_.points[static_cast<std::size_t>(nodes[i])];
  if (!imposed_by_.empty())
    cell.imposed_by = imposed_by_.data() + entity * mesh_.per_entity * mesh_.components;
  return cell;
}

void EntitySum::set_dual(Index vertices, int components, SparseMatrix gram) {
  for (Index i = 0; i < vertices; ++i) {
    dual_.vertices.push_back(i);
    dual_.points.push_back(mesh_.points[static_cast<std::size_t>(i)]);
  }
  dual_.components = components;
  dual_.gram = std::move(gram);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index e = 0; e < mesh_.count(); ++e)
    for (const Index row : rows_of(e))
      for (const Index column : columns_of(e))
        if (column >= 0) entries.emplace_back(row, column, 0.0);
  pattern_.resize(dual_.size(), mesh_.columns);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  pattern_.makeCompressed();
  for (Index e = 0; e < mesh_.count(); ++e)
    for (const Index row : rows_of(e))
      for (const Index column : columns_of(e))
        position_.push_back(column < 0 ? -1
                                       : &pattern_.coeffRef(row, column) - pattern_.valuePtr());
}

std::vector<Point> EntitySum::mapped_vertices(const FullMu &mu) const {
  std::vector<Point> mapped;
  mapped.reserve(static_cast<std::size_t>(dual_.nodes()));
  for (Index i = 0; i < dual_.nodes(); ++i)
    mapped.push_back(scene_.map(mu, mesh_.points[static_cast<std::size_t>(i)]));
  return mapped;
}

template <class IsWanted, class Visit>
void EntitySum::visit_entities(const FullMu &mu, const std::vector<Point> &mapped,
                               IsWanted &&is_wanted, Visit &&visit) const {
  if (entity_dim_ == 1) check_lengths(mu, mapped);
  for (Index e = 0; e < mesh_.count(); ++e) {
    if (!is_wanted(e)) continue;
    Cell cell = reference_entity(e);
    const int *nodes = mesh_.nodes_of(e);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(entity_dim_); ++i)
      cell.mapped[i] = mapped[static_cast<std::size_t>(nodes[i])];
    if (entity_dim_ > 1) check_orientation(scene_, mu, cell);
    visit(e, cell);
  }
}

void EntitySum::check_lengths(const FullMu &mu, const std::vector<Point> &mapped) const {
  const auto length = [&](Index e) {
    const int *nodes = mesh_.nodes_of(e);
    const Point &a = mapped[static_cast<std::size_t>(nodes[0])],
                &b = mapped[static_cast<std::size_t>(nodes[1])];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
  };
  double longest = 0;
  for (Index e = 0; e < mesh_.count(); ++e)
    longest = std::max(longest, length(e));
  for (Index e = 0; e < mesh_.count(); ++e)
    if (!(length(e) > 1e-12 * longest))
      throw failure("edge " + std::to_string(e) +
                    " of the contact boundary has no length, mapped at " +
                    describe(scene_.parameters, mu));
}

void EntitySum::assemble(const FullMu &mu, const ContactState &, ContactOperators &operators) {
  clear(pattern_, operators.b);
  operators.g = Vector::Zero(dual_.size());
  operators.weights = Vector::Zero(dual_.nodes());
  EntityValues values = shape();
  const Index *position = position_.data();
  const std::vector<Point> mapped = mapped_vertices(mu);
  const auto all = [](Index) { return true; };
  visit_entities(mu, mapped, all, [&](Index e, const Cell &cell) {
    integrate_beside_imposed(mu, cell, values);
    for (Index k = 0; k < values.b.size(); ++k, ++position)
      if (*position >= 0) operators.b.valuePtr()[*position] += values.b.data()[k];
    const std::vector<Index> dual = rows_of(e);
    for (std::size_t i = 0; i < dual.size(); ++i)
      operators.g[dual[i]] += values.g[static_cast<Index>(i)];
    add_weights(mu, e, cell, values, operators.weights);
  });
  set_constraints(mu, mapped, operators);
}

void EntitySum::assemble_nodal(const FullMu &mu, const ContactState &, const Vector &lambda,
                               ContactOperators &operators) {
  operators.weights = Vector::Zero(dual_.nodes());
  EntityValues values = shape();
  const std::vector<Point> mapped = mapped_vertices(mu);
  const auto is_wanted = [&](Index e) {
    const int *nodes = mesh_.nodes_of(e);
    return lambda.size() == 0 || dual_.components > 1 ||
           std::any_of(nodes, nodes + entity_dim_ + 1, [&](int node) { return lambda[node] != 0; });
  };
  visit_entities(mu, mapped, is_wanted, [&](Index e, const Cell &cell) {
    add_weights(mu, e, cell, values, operators.weights);
  });
  set_constraints(mu, mapped, operators);
}

void EntitySum::add_weights(const FullMu &mu, Index entity, const Cell &cell, EntityValues &values,
                            Vector &weights) const {
  weigh(mu, cell, values);
  for (int a = 0; a <= entity_dim_; ++a)
    weights[mesh_.nodes_of(entity)[a]] += values.weights[a];
}

} // namespace rbvi
