#include "nodal_steps.hpp"

#include "fixed_point.hpp"
#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// v with A^T loads added, A the average.
void add_loads(const SparseMatrix &average, const Eigen::Matrix2Xd &loads, Vector &v) {
  for (Index row = 0; row < loads.size(); ++row)
    if (const double load = loads.data()[row]; load != 0)
      for (SparseMatrix::InnerIterator entry(average, row); entry; ++entry)
        v[entry.col()] += load * entry.value();
}

std::vector<Index> carrying(const NodeLaws &laws, const Vector &x) {
  std::vector<Index> result;
  for (Index node = 0; node < laws.nodes(); ++node)
    if (x[laws.normal[node]] != 0 || (laws.has_tangent(node) && x[laws.tangent[node]] != 0))
      result.push_back(node);
  return result;
}

} // namespace

std::vector<Index> NodalSteps::touching(const Vector &x) const {
  const NodeLaws &laws = contact_.laws;
  std::vector<Index> result;
  for (Index node = 0; node < laws.nodes(); ++node)
    if (!near_.empty() && !near_[node])
      continue;
    else if (x[laws.normal[node]] != 0 || here_.w[laws.normal[node]] < 0 ||
             (laws.has_tangent(node) && x[laws.tangent[node]] != 0))
      result.push_back(node);
  return result;
}

double NodalSteps::diagonal(Index node, const Frame &along) const {
  return along.dot(contact_.nodal->compliance.block(node, node) * along);
}

/// At the other nodes the mean of the known ones.
Vector NodalSteps::diagonals(const std::vector<Index> &known) const {
  const NodeLaws &laws = contact_.laws;
  double sum = 0;
  for (const Index node : known)
    sum += diagonal(node, normal(node));
  const double mean = known.empty() ? 1 : sum / static_cast<double>(known.size());
  Vector result = Vector::Constant(laws.rows, mean);
  for (const Index node : known) {
    result[laws.normal[node]] = diagonal(node, normal(node));
    if (laws.has_tangent(node)) result[laws.tangent[node]] = diagonal(node, tangent(node));
  }
  return result;
}

/// Whether the normals of these nodes have turned by so little since `before` that a tangent made
/// there contracts as well.
bool NodalSteps::are_as_before(const std::vector<Index> &nodes,
                               const Eigen::Matrix2Xd &before) const {
  constexpr double turned = 3e-3;
  return before.cols() > 0 && std::ranges::all_of(nodes, [&](Index node) {
           return (here_.normal.col(node) - before.col(node)).norm() <=
                  turned * before.col(node).norm();
         });
}

void NodalSteps::set_tangent(const std::vector<Index> &active) {
  if (active == active_ && are_as_before(active, tangent_at_)) return;
  active_ = active;
  tangent_at_ = here_.normal;
  const Index n = std::ssize(active_), first = n > 0 ? active_.front() : 0,
              count = n > 0 ? active_.back() + 1 - first : 0;
  const NodalCompliance &compliance = contact_.nodal->compliance;
  Eigen::Matrix2Xd across(2, n), along = here_.normal(Eigen::all, active_);
  for (Index a = 0; a < n; ++a)
    across.col(a) = tangent(active_[a]).normalized();
  Matrix h(n, n);
  p_.resize(n, n);
  q_.resize(n, n);
  Eigen::Matrix2Xd under_normal(2, count), under_tau(2, count);
  for (Index b = 0; b < n; ++b) {
    const Index node = active_[b];
    under_normal.reshaped() = compliance.moved_nodes(node, along.col(b), first, count);
    under_tau.reshaped() = compliance.moved_nodes(node, across.col(b), first, count);
    for (Index a = 0; a < n; ++a) {
      const Index under = active_[a] - first;
      h(a, b) = along.col(a).dot(under_normal.col(under));
      p_(a, b) = across.col(a).dot(under_normal.col(under));
      q_(a, b) = across.col(a).dot(under_tau.col(under));
    }
  }
  factor_ = cholesky(std::move(h), "the compliance between the nodes in contact");
}

/// With t the tangential displacements, z = rotation t, y the change of x on the active nodes:
///
///   w - n . e + H y - P^T z = 0,      t = tau . e - P y + Q z.
Eigen::Matrix2Xd NodalSteps::newton_on_active(double tolerance, Vector &x) const {
  const NodalCompliance &compliance = contact_.nodal->compliance;
  const Index n = std::ssize(active_);
  Eigen::Matrix2Xd loads = Eigen::Matrix2Xd::Zero(2, e_.cols()), e = e_(Eigen::all, active_);
  for (Index node = 0; node < e_.cols(); ++node) { // what leaves contact
    double &value = x[contact_.laws.normal[node]];
    if (value == 0 || std::binary_search(active_.begin(), active_.end(), node)) continue;
    loads.col(node) = -value * normal(node);
    value = 0;
    for (Index a = 0; a < n; ++a)
      e.col(a) -= compliance.block(active_[a], node) * loads.col(node);
  }
  Vector gap(n), slip(n), rotation(n);
  for (Index a = 0; a < n; ++a) {
    const Index node = active_[a];
    gap[a] = here_.w[contact_.laws.normal[node]] - normal(node).dot(e.col(a));
    slip[a] = tangent(node).normalized().dot(e.col(a));
    rotation[a] = here_.rotation[node];
  }
  const Vector right = slip + p_ * cholesky_solve(factor_, gap);
  const Vector t = fixed_point(right, tolerance, [&](const Vector &moved) -> Vector {
    const Vector z = rotation.cwiseProduct(moved);
    return p_ * cholesky_solve(factor_, p_.transpose() * z) - q_ * z;
  });
  const Vector z = rotation.cwiseProduct(t);
  const Vector y = cholesky_solve(factor_, p_.transpose() * z - gap);
  for (Index a = 0; a < n; ++a) {
    const Index node = active_[a];
    x[contact_.laws.normal[node]] += y[a];
    loads.col(node) = y[a] * normal(node) - z[a] * tangent(node).normalized();
  }
  return loads;
}

/// The first of the nodes that are near, and how many there are up to the last.
Compliance::Range NodalSteps::near_range() const {
  const Index nodes = contact_.laws.nodes();
  if (near_.empty()) return {0, nodes};
  const auto first = std::find(near_.begin(), near_.end(), true) - near_.begin();
  const auto after = std::find(near_.rbegin(), near_.rend(), true) - near_.rbegin();
  return {first, std::max<Index>(0, nodes - after - first)};
}

/// Active nodes that pull, and others near that overlap under `loads`.
std::vector<Index> NodalSteps::violated(const Vector &x, const Eigen::Matrix2Xd &loads) const {
  constexpr double round_off = 1e-12;
  const NodalCompliance &compliance = contact_.nodal->compliance;
  const double largest_x = x.maxCoeff(), largest_w = here_.w.cwiseAbs().maxCoeff();
  const auto [first, count] = near_range();
  Eigen::Matrix2Xd moved = e_;
  for (Index node = 0; node < loads.cols(); ++node)
    if (loads(0, node) != 0 || loads(1, node) != 0)
      moved.middleCols(first, count).reshaped() -=
          compliance.moved_nodes(node, loads.col(node), first, count);
  std::vector<Index> result;
  for (Index node = first; node < first + count; ++node) {
    if (!near_.empty() && !near_[node]) continue;
    const Index row = contact_.laws.normal[node];
    if (std::binary_search(active_.begin(), active_.end(), node)) {
      if (x[row] < -round_off * largest_x) result.push_back(node);
      continue;
    }
    if (here_.w[row] - normal(node).dot(moved.col(node)) < -round_off * largest_w)
      result.push_back(node);
  }
  return result;
}

Eigen::Matrix2Xd NodalSteps::newton(Vector &x, double change) {
  constexpr int most_sets = 10;
  std::vector<Index> active;
  for (const Index node : touching(x)) {
    const Index row = contact_.laws.normal[node];
    const double gap = here_.w[row] - normal(node).dot(e_.col(node));
    if (x[row] - gap / diagonal(node, normal(node)) > 0) active.push_back(node);
  }
  const Vector start = x;
  for (int set = 1;; ++set) {
    set_tangent(active);
    x = start;
    Eigen::Matrix2Xd loads = newton_on_active(std::clamp(0.1 * change, 1e-8, 1e-2), x);
    const std::vector<Index> wrong = violated(x, loads);
    if (wrong.empty() || set == most_sets) return loads;
    active = pivoting::exchanged(active, wrong);
    contact_.nodal->compliance.require(active, *contact_.compliance);
  }
}

/// The nodes near contact with laws of their own, and no column of H yet.
void NodalSteps::begin_near() {
  const NodeLaws &laws = contact_.laws;
  near_nodes_.clear();
  near_laws_ = {};
  for (Index node = 0; node < laws.nodes(); ++node)
    if (near_.empty() || near_[node]) {
      near_nodes_.push_back(node);
      near_laws_.bound.push_back(laws.bound[node]);
    }
  const Index count = std::ssize(near_nodes_);
  for (Index k = 0; k < count; ++k) {
    near_laws_.normal.push_back(k);
    near_laws_.tangent.push_back(count + k);
  }
  near_laws_.rows = 2 * count;
  near_rows_ = near_nodes_;
  for (const Index node : near_nodes_)
    near_rows_.push_back(laws.nodes() + node);
  h_.resize(2 * count, 2 * count);
  known_.assign(2 * count, false);
}

/// Columns of H between the nodes that are near; kept as long as the normals.
Matrix NodalSteps::columns(const std::vector<Index> &which) {
  const Index count = std::ssize(near_nodes_);
  NodalCompliance &compliance = contact_.nodal->compliance;
  std::vector<Index> fresh, of_fresh;
  for (const Index row : which)
    if (!known_[row]) {
      fresh.push_back(row);
      of_fresh.push_back(near_nodes_[row % count]);
    }
  compliance.require(of_fresh, *contact_.compliance);
  for (const Index row : fresh) {
    known_[row] = true;
    const Index node = near_nodes_[row % count];
    const Frame load = row < count ? normal(node) : tangent(node);
    const Index first = near_nodes_.front(), last = near_nodes_.back();
    const Vector moved = compliance.moved_nodes(node, load, first, last + 1 - first);
    for (Index k = 0; k < count; ++k) {
      const Index a = near_nodes_[k];
      const auto of_node = moved.segment<2>(2 * (a - first));
      h_(k, row) = normal(a).dot(of_node);
      h_(count + k, row) = tangent(a).dot(of_node);
    }
  }
  return h_(Eigen::all, which);
}

/// The laws of the nodes near contact, with H between them and what is left of w beside H x.
Eigen::Matrix2Xd NodalSteps::kacanov(const Iterate &last, Iterate &next) {
  const NodeLaws &laws = contact_.laws;
  if (!are_as_before(touching(last.x), tangent_at_)) {
    begin_near();
    tangent_at_ = here_.normal;
  }
  const auto columns = [this](const std::vector<Index> &which) { return this->columns(which); };
  const Index count = std::ssize(near_nodes_);
  const Vector x = last.x(near_rows_);
  Vector q = here_.w(near_rows_);
  std::vector<Index> loaded;
  for (Index k = 0; k < count; ++k) {
    const Index node = near_nodes_[k];
    q[k] -= normal(node).dot(e_.col(node));
    q[count + k] -= tangent(node).dot(e_.col(node));
  }
  for (Index row = 0; row < x.size(); ++row)
    if (x[row] != 0) loaded.push_back(row);
  q -= columns(loaded) * x(loaded);
  const FrictionResult found = solve_friction(
      columns, q, near_laws_, last.start.size() > 0 ? Vector(last.start(near_rows_)) : Vector());
  if (!found.converged) throw failure(found.reason);
  Eigen::Matrix2Xd loads = Eigen::Matrix2Xd::Zero(2, laws.nodes());
  for (Index k = 0; k < count; ++k) {
    const Index node = near_nodes_[k];
    loads.col(node) =
        (found.x[k] - x[k]) * normal(node) + (found.x[count + k] - x[count + k]) * tangent(node);
  }
  next.x = next.start = Vector::Zero(laws.rows);
  next.x(near_rows_) = found.x;
  next.start(near_rows_) = found.start;
  for (const Index k : found.active)
    next.active.push_back(near_nodes_[k]);
  return loads;
}

Iterate NodalSteps::step(const Vector &state, const Iterate &last, double change) {
  NodalCompliance &compliance = contact_.nodal->compliance;
  if (rows_.empty()) see(carrying(contact_.laws, last.x));
  contact_.nodal->evaluate(state, last.x, near_, here_);
  const std::vector<Index> nodes = touching(last.x);
  compliance.require(nodes, *contact_.compliance);
  Iterate next;
  next.u = state;
  for (const auto &[first, count] : rows_)
    next.u.segment(first, count) = contact_.free.segment(first, count);
  LoadedColumns of_dofs, of_nodes;
  of_dofs.add(here_.load, *contact_.compliance);
  subtract(of_dofs, next.u);
  e_ = (compliance.average() * (next.u - state)).reshaped(2, contact_.laws.nodes());
  Eigen::Matrix2Xd loads;
  if (contact_.laws.has_tangents()) {
    loads = kacanov(last, next);
  } else {
    next.x = last.x;
    loads = newton(next.x, change);
    next.active = active_;
  }
  for (Index node = 0; node < loads.cols(); ++node)
    for (Index c = 0; c < 2; ++c)
      if (loads(c, node) != 0)
        of_nodes.add(loads(c, node), compliance.moved(node).col(c).data(), {0, next.u.size()});
  subtract(of_nodes, next.u);
  next.reaction = here_.load;
  add_loads(compliance.average(), loads, next.reaction);
  next.diagonal = diagonals(nodes);
  if (next.active != last.active) see(next.active);
  return next;
}

void NodalSteps::see(const std::vector<Index> &nodes) {
  constexpr int layers = 4;
  if (near_.empty() && !rows_.empty()) return;
  const NodalCompliance &compliance = contact_.nodal->compliance;
  std::vector<Index> front = nodes;
  const std::vector<bool> before = rows_.empty() ? std::vector<bool>{true} : near_;
  for (int layer = 0; layer <= layers && !near_.empty(); ++layer) {
    std::vector<Index> next;
    for (const Index node : front)
      if (layer == 0 || !near_[node]) {
        near_[node] = true;
        const std::vector<Index> &beside = compliance.neighbours(node);
        next.insert(next.end(), beside.begin(), beside.end());
      }
    front = std::move(next);
  }
  if (near_ == before) return;
  if (contact_.laws.has_tangents()) tangent_at_.resize(2, 0); // H is wanted at further nodes
  std::vector<bool> wanted(contact_.free.size(), near_.empty());
  for (Index row = 0; row < compliance.average().rows() && !near_.empty(); ++row)
    if (near_[row / 2])
      for (SparseMatrix::InnerIterator entry(compliance.average(), row); entry; ++entry)
        wanted[entry.col()] = true;
  rows_.clear();
  for (Index dof = 0; dof < std::ssize(wanted); ++dof)
    if (wanted[dof]) {
      if (rows_.empty() || rows_.back().first + rows_.back().count != dof)
        rows_.push_back({dof, 0});
      ++rows_.back().count;
    }
}

bool NodalSteps::complete(Iterate &iterate) {
  const std::vector<bool> seen = std::exchange(near_, {});
  if (!seen.empty()) {
    if (contact_.laws.has_tangents()) tangent_at_.resize(2, 0);
    rows_ = {{0, contact_.free.size()}};
    iterate.u = contact_.free;
    LoadedColumns of_dofs;
    of_dofs.add(iterate.reaction, *contact_.compliance);
    subtract(of_dofs, iterate.u);
  }
  contact_.nodal->evaluate(iterate.u, iterate.x, near_, here_);
  const std::vector<Index> nodes = touching(iterate.x);
  return seen.empty() || std::ranges::all_of(nodes, [&](Index node) { return bool(seen[node]); });
}

} // namespace rbvi
