#include "rbvi/contact/entity_sum.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/imposed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
      imposed_by_.push_back(mesh_.imposed_by[mesh_.entities[i] * mesh_.components + c]);
}

void EntitySum::integrate_beside_imposed(const FullMu &mu, const Cell &entity,
                                         EntityValues &values) const {
  integrate(mu, entity, values);
  if (entity.imposed_by == nullptr) return;
  const std::vector<int> imposed_by(entity.imposed_by, entity.imposed_by + values.b.cols());
  const std::vector<Point> nodes = node_points(entity_dim_, mesh_.degree, entity);
  values.g -= values.b * imposed_values(scene_, mu, nodes, imposed_by);
}

void EntitySum::set_displacement(const FullMu &mu, Index entity, const ContactState &state,
                                 Cell &cell, std::vector<double> &values) const {
  if (state.displacement.size() == 0) return;
  const auto components = static_cast<std::size_t>(mesh_.components);
  values.assign(static_cast<std::size_t>(mesh_.per_entity) * components, 0);
  const int *nodes = mesh_.nodes_of(entity);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto node = static_cast<std::size_t>(nodes[k / components]);
    const int dof = mesh_.dofs[node * components + k % components];
    if (dof >= 0) values[k] = state.displacement[dof];
  }
  if (cell.imposed_by != nullptr) {
    const std::vector<int> imposed_by(cell.imposed_by, cell.imposed_by + values.size());
    const std::vector<Point> points = node_points(entity_dim_, mesh_.degree, cell);
    Eigen::Map<Vector>(values.data(), std::ssize(values)) +=
        imposed_values(scene_, mu, points, imposed_by);
  }
  cell.displacement = values.data();
}

std::span<const int> EntitySum::rows_of(Index entity) const {
  return std::span(rows_).subspan(entity * rows(), static_cast<std::size_t>(rows()));
}

std::vector<Index> EntitySum::columns_of(Index entity) const {
  const int *nodes = mesh_.nodes_of(entity);
  std::vector<Index> result;
  for (int i = 0; i < mesh_.per_entity; ++i)
    for (int c = 0; c < mesh_.components; ++c)
      result.push_back(mesh_.dofs[nodes[i] * mesh_.components + c]);
  return result;
}

Cell EntitySum::reference_entity(Index entity) const {
  Cell cell{entity_dim_, {}, {}};
  const int *nodes = mesh_.nodes_of(entity);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(entity_dim_); ++i)
    cell.reference[i] = mesh_.points[nodes[i]];
  if (!imposed_by_.empty())
    cell.imposed_by = imposed_by_.data() + entity * mesh_.per_entity * mesh_.components;
  return cell;
}

bool EntitySum::can_move(int node) const {
  const auto first = mesh_.dofs.begin() + node * mesh_.components;
  return std::any_of(first, first + mesh_.components, [](int dof) { return dof >= 0; });
}

/// EntitySum::dual_of_vertex.
std::vector<Index> EntitySum::dual_functions(Index vertices, bool lumped) const {
  std::vector<Index> result(vertices, -1);
  Index count = 0;
  for (Index v = 0; v < vertices; ++v)
    if (can_move(static_cast<int>(v))) result[v] = count++;
  if (count == 0)
    throw bad_input(
        "scene " + scene_.name +
        ": the displacement is fixed on all of a contact interface, which cannot move it");
  if (count == vertices || lumped) return result;
  for (std::vector<Index> own; own != result;) { // layer by layer of fixed vertices
    own = result;
    std::vector<double> nearest(result.size(), std::numeric_limits<double>::infinity());
    for (Index e = 0; e < mesh_.count(); ++e)
      for (int a = 0; a <= entity_dim_; ++a)
        for (int b = 0; b <= entity_dim_; ++b) {
          const auto fixed = static_cast<std::size_t>(mesh_.nodes_of(e)[a]),
                     beside = static_cast<std::size_t>(mesh_.nodes_of(e)[b]);
          if (own[fixed] >= 0 || own[beside] < 0) continue;
          const Point &x = mesh_.points[fixed], &y = mesh_.points[beside];
          const double distance = std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
          if (!(distance < nearest[fixed])) continue;
          nearest[fixed] = distance;
          result[fixed] = own[beside];
        }
  }
  return result;
}

/// None of an entity that cannot move at all.
void EntitySum::set_rows() {
  const Index tangents = dual_.components - 1;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const int *nodes = mesh_.nodes_of(e);
    const bool moves =
        std::any_of(nodes, nodes + mesh_.per_entity, [&](int node) { return can_move(node); });
    const auto dual = [&](int a) { return moves ? dual_of_vertex_[nodes[a]] : Index{-1}; };
    for (int a = 0; a <= entity_dim_; ++a)
      rows_.push_back(static_cast<int>(dual(a)));
    for (int a = 0; a <= entity_dim_; ++a)
      for (Index k = 0; k < tangents; ++k)
        rows_.push_back(dual(a) < 0 ? -1
                                    : static_cast<int>(dual_.nodes() + dual(a) * tangents + k));
  }
}

void EntitySum::set_dual(Index vertices, int components, bool lumped, const SparseMatrix &gram) {
  dual_of_vertex_ = dual_functions(vertices, lumped);
  for (Index v = 0; v < vertices; ++v) {
    if (!can_move(static_cast<int>(v))) continue;
    dual_.vertices.push_back(v);
    dual_.points.push_back(mesh_.points[v]);
  }
  dual_.components = components;
  const Index tangents = components - 1;
  std::vector<Eigen::Triplet<double>> parts; // hats -> dual functions
  for (Index v = 0; v < vertices; ++v) {
    const Index dual = dual_of_vertex_[v];
    if (dual < 0) continue;
    parts.emplace_back(dual, v, 1.0);
    for (Index k = 0; k < tangents; ++k)
      parts.emplace_back(dual_.nodes() + dual * tangents + k, vertices + v * tangents + k, 1.0);
  }
  SparseMatrix sum(dual_.size(), gram.rows());
  sum.setFromTriplets(parts.begin(), parts.end());
  dual_.gram = dual_.nodes() == vertices ? gram : SparseMatrix(sum * gram * sum.transpose());
  set_rows();
}

std::vector<std::array<double, 2>> EntitySum::held_gaps(const FullMu &mu) const {
  std::vector<Index> held;
  std::vector<Point> points;
  for (Index v = 0; v < std::ssize(dual_of_vertex_); ++v)
    if (!can_move(static_cast<int>(v))) {
      held.push_back(v);
      points.push_back(mesh_.points[v]);
    }
  if (held.empty()) return {};
  const std::vector<Point> mapped = images(scene_.map, mu, points);
  const Vector imposed = imposed_values(scene_, mu, mesh_.points, mesh_.imposed_by);
  std::vector<std::array<double, 2>> gaps;
  for (std::size_t k = 0; k < held.size(); ++k) {
    Point displacement{};
    for (int c = 0; c < mesh_.components && imposed.size() > 0; ++c)
      displacement[c] = imposed[held[k] * mesh_.components + c];
    const PointConstraint at = constraint_at(mu, points[k], mapped[k], displacement);
    gaps.push_back({at.gap - dot(at.direction, displacement),
                    std::abs(at.gap) + norm(displacement) + norm(mapped[k])});
  }
  return gaps;
}

std::vector<bool> EntitySum::entities_at(const WantedNodes &wanted) const {
  if (wanted.empty()) return {};
  std::vector<bool> result(mesh_.count(), false);
  for (Index e = 0; e < mesh_.count(); ++e)
    for (const int dual : rows_of(e).first(static_cast<std::size_t>(entity_dim_) + 1))
      if (dual >= 0 && wanted[dual]) result[e] = true;
  return result;
}

void EntitySum::set_pattern(const WantedNodes &wanted) {
  pattern_wanted_ = wanted;
  const std::vector<bool> entities = entities_at(wanted);
  const Index tangents = dual_.components - 1;
  const auto wanted_row = [&](Index row) {
    return row >= 0 &&
           is_wanted(wanted, row < dual_.nodes() ? row : (row - dual_.nodes()) / tangents);
  };
  std::vector<Eigen::Triplet<double>> entries;
  const auto visit = [&](auto &&add) {
    for (Index e = 0; e < mesh_.count(); ++e) {
      if (!entities.empty() && !entities[e]) continue;
      const std::vector<Index> columns = columns_of(e);
      for (const Index row : rows_of(e))
        for (const Index column : columns)
          add(wanted_row(row) ? row : -1, column);
    }
  };
  visit([&](Index row, Index column) {
    if (row >= 0 && column >= 0) entries.emplace_back(row, column, 0.0);
  });
  pattern_.resize(dual_.size(), mesh_.columns);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  pattern_.makeCompressed();
  position_.clear();
  visit([&](Index row, Index column) {
    position_.push_back(row < 0 || column < 0 ? -1
                                              : static_cast<int>(&pattern_.coeffRef(row, column) -
                                                                 pattern_.valuePtr()));
  });
}

std::vector<Point> EntitySum::mapped_vertices(const FullMu &mu,
                                              const std::vector<bool> &entities) const {
  std::vector<bool> needed(dual_of_vertex_.size(), entities.empty() || entity_dim_ < mesh_.dim);
  for (std::size_t e = 0; e < entities.size(); ++e)
    for (int a = 0; a <= entity_dim_ && entities[e]; ++a)
      needed[mesh_.nodes_of(static_cast<Index>(e))[a]] = true;
  std::vector<Point> mapped(mesh_.points.begin(),
                            mesh_.points.begin() + std::ssize(dual_of_vertex_));
  std::vector<Point> wanted;
  for (std::size_t i = 0; i < mapped.size(); ++i)
    if (needed[i]) wanted.push_back(mapped[i]);
  const std::vector<Point> image = images(scene_.map, mu, wanted);
  for (std::size_t i = 0, k = 0; i < mapped.size(); ++i)
    if (needed[i]) mapped[i] = image[k++];
  return mapped;
}

template <class Visit>
void EntitySum::visit_entities(const FullMu &mu, const std::vector<Point> &mapped,
                               const std::vector<bool> &entities, Visit &&visit) const {
  if (entity_dim_ < mesh_.dim) check_sizes(mu, mapped);
  for (Index e = 0; e < mesh_.count(); ++e) {
    if (!entities.empty() && !entities[e]) continue;
    Cell cell = reference_entity(e);
    const int *nodes = mesh_.nodes_of(e);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(entity_dim_); ++i)
      cell.mapped[i] = mapped[nodes[i]];
    if (entity_dim_ == mesh_.dim) check_orientation(scene_, mu, cell);
    visit(e, cell);
  }
}

void EntitySum::check_sizes(const FullMu &mu, const std::vector<Point> &mapped) const {
  Vector squared(mesh_.count());
  for (Index e = 0; e < mesh_.count(); ++e) {
    const int *nodes = mesh_.nodes_of(e);
    const Point &a = mapped[nodes[0]], along = mapped[nodes[1]] - a;
    const Point size = entity_dim_ == 1 ? along : cross(along, mapped[nodes[2]] - a);
    squared[e] = dot(size, size);
  }
  const double least = 1e-24 * (squared.size() > 0 ? squared.maxCoeff() : 0);
  for (Index e = 0; e < mesh_.count(); ++e)
    if (!(squared[e] > least))
      throw failure((entity_dim_ == 1 ? "edge " : "triangle ") + std::to_string(e) +
                    " of the contact boundary has no size, mapped at " +
                    describe(scene_.parameters, mu));
}

void EntitySum::sum(const FullMu &mu, const ContactState &state, const WantedNodes &wanted,
                    bool with_b, ContactOperators &operators) {
  EntityValues values = shape();
  if (with_b) {
    if (pattern_.rows() == 0 || wanted != pattern_wanted_) set_pattern(wanted);
    clear(pattern_, operators.b);
  } else {
    values.b.resize(rows(), 0);
  }
  operators.g = Vector::Zero(dual_.size());
  operators.weights = Vector::Zero(dual_.nodes());
  const int *position = position_.data();
  const std::vector<bool> entities = entities_at(wanted);
  const std::vector<Point> mapped = mapped_vertices(mu, entities);
  std::vector<double> displacement;
  visit_entities(mu, mapped, entities, [&](Index e, Cell &cell) {
    if (follows_state()) set_displacement(mu, e, state, cell, displacement);
    integrate_beside_imposed(mu, cell, values);
    for (Index k = 0; k < values.b.size(); ++k, ++position)
      if (*position >= 0) operators.b.valuePtr()[*position] += values.b.data()[k];
    const std::span<const int> dual = rows_of(e);
    for (std::size_t i = 0; i < dual.size(); ++i)
      if (dual[i] >= 0) operators.g[dual[i]] += values.g[static_cast<Index>(i)];
    add_weights(mu, e, cell, values, operators.weights);
  });
  set_constraints(mu, mapped, state, wanted, operators);
  check_partly_fixed(wanted, operators);
  if (follows_state()) operators.state = state;
  for (Index i = 0; i < dual_.nodes() && !wanted.empty(); ++i) {
    if (is_wanted(wanted, i)) continue; // else some of its entities were left out
    const Index tangents = dual_.components - 1;
    operators.g[i] = operators.weights[i] = 0;
    operators.g.segment(dual_.nodes() + i * tangents, tangents).setZero();
  }
}

void EntitySum::check_partly_fixed(const WantedNodes &wanted,
                                   const ContactOperators &operators) const {
  constexpr double along = 1e-6; // of a unit normal
  for (const Index node : partly_fixed())
    if (is_wanted(wanted, node) && !(operators.nodal_b.row(node).norm() > along)) {
      const Point &x = dual_.points[node];
      throw bad_input("the displacement is fixed along the normal of contact at " +
                      short_number(x[0]) + " " + short_number(x[1]) +
                      ", where contact cannot move it: fix it in all directions there");
    }
}

void EntitySum::assemble_nodal(const FullMu &mu, const ContactState &state, const Vector &lambda,
                               ContactOperators &operators) {
  operators.weights = Vector::Zero(dual_.nodes());
  EntityValues values = shape();
  const Index tangents = dual_.components - 1;
  WantedNodes loaded(lambda.size() > 0 ? static_cast<std::size_t>(dual_.nodes()) : 0, false);
  for (Index i = 0; i < std::ssize(loaded); ++i)
    if (lambda[i] != 0 || !lambda.segment(dual_.nodes() + i * tangents, tangents).isZero(0))
      loaded[i] = true;
  const std::vector<Point> mapped = mapped_vertices(mu, {});
  visit_entities(mu, mapped, entities_at(loaded), [&](Index e, const Cell &cell) {
    add_weights(mu, e, cell, values, operators.weights);
  });
  set_constraints(mu, mapped, state, {}, operators);
  if (follows_state()) operators.state = state;
}

Vector EntitySum::nodal_forces(const FullMu &mu, const ContactState &state,
                               const Vector &lambda) const {
  Vector forces = Vector::Zero(mesh_.nodes() * mesh_.components);
  EntityValues values = shape();
  std::vector<double> displacement;
  visit_entities(mu, mapped_vertices(mu, {}), {}, [&](Index e, Cell &cell) {
    Vector own = Vector::Zero(rows());
    const std::span<const int> dual = rows_of(e);
    for (std::size_t i = 0; i < dual.size(); ++i)
      if (dual[i] >= 0) own[static_cast<Index>(i)] = lambda[dual[i]];
    if (own.isZero(0)) return;
    if (follows_state()) set_displacement(mu, e, state, cell, displacement);
    integrate(mu, cell, values);
    const Vector of_nodes = values.b.transpose() * own;
    for (Index k = 0; k < of_nodes.size(); ++k)
      forces[mesh_.nodes_of(e)[k / mesh_.components] * mesh_.components + k % mesh_.components] +=
          of_nodes[k];
  });
  return forces;
}

void EntitySum::add_weights(const FullMu &mu, Index entity, const Cell &cell, EntityValues &values,
                            Vector &weights) const {
  weigh(mu, cell, values);
  const std::span<const int> rows = rows_of(entity);
  for (int a = 0; a <= entity_dim_; ++a)
    if (const Index dual = rows[a]; dual >= 0) weights[dual] += values.weights[a];
}

} // namespace rbvi
