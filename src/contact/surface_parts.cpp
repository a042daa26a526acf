#include "surface_parts.hpp"

#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/simplex_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Barycentric between(std::size_t i, std::size_t j) {
  Barycentric point{};
  point[i] += 0.5;
  point[j] += 0.5;
  return point;
}

/// Whether the vertices of a triangle touch, and whether they stick.
using VertexStates = std::array<std::array<bool, 3>, 2>;

/// Parts in which all is alike: what holds at a vertex does up to the middles of its edges, and
/// what holds at two of them between these.
std::vector<ContactSurface::Part> parts_of(const VertexStates &holds) {
  const auto count = [](const std::array<bool, 3> &of) { return std::ranges::count(of, true); };
  const std::array<std::ptrdiff_t, 2> counts{count(holds[0]), count(holds[1])};
  const std::array<bool, 2> most{counts[0] > 1, counts[1] > 1};
  if (std::ranges::all_of(counts, [](std::ptrdiff_t of) { return of % 3 == 0; }))
    return {{{2, {between(0, 0), between(1, 1), between(2, 2)}}, most}};
  std::vector<ContactSurface::Part> parts{
      {{2, {between(0, 1), between(1, 2), between(2, 0)}}, most}};
  for (std::size_t v = 0; v < 3; ++v)
    parts.push_back({{2, {between(v, v), between(v, (v + 1) % 3), between(v, (v + 2) % 3)}},
                     {holds[0][v], holds[1][v]}});
  return parts;
}

/// Rows of the values of all fields at nodes.
enum : Index {
  point = 0,
  moved = 3,
  sheared = 6,
  slid = 9,
  pressed = 12,
  open = 13,
  raised = 14, ///< of a membrane
  rows = 15
};

} // namespace

ContactSurface::ContactSurface(const Grid &grid, const FrictionBound &bound, double least)
    : cells_(grid.cells), per_cell_(grid.per_cell),
      values_(Matrix::Constant(rows, grid.points.rows(), none)), pull_(bound.pull) {
  const auto set = [&](Index first, const std::string &name, Index components) {
    const auto found = std::ranges::find(grid.of_nodes, name, &Field::name);
    if (found != grid.of_nodes.end())
      values_.middleRows(first, components) =
          found->values.reshaped(components, grid.points.rows());
  };
  const bool membrane = grid.points.cols() == 2;
  values_.row(2).setZero();
  values_.topRows(grid.points.cols()) = grid.points.transpose();
  set(membrane ? raised : moved, "u", membrane ? 1 : 3);
  set(sheared, "tangential_stress", 3);
  set(slid, "slip", 3);
  set(pressed, "pressure", 1);
  set(open, "gap", 1);
  auto shear = values_.middleRows(sheared, 3);
  if (shear.array().isNaN().any()) shear.setZero();
  const Vector pressure = values_.row(pressed).transpose(), sizes = shear.colwise().norm();
  const Vector most = pressure.unaryExpr([&](double p) { return bound.value(p); });
  const double violation = friction_violation(sizes, most);
  for (Index k = 0; k < std::ssize(cells_) / per_cell_; ++k) {
    const int *nodes = nodes_of(k);
    VertexStates holds;
    for (std::size_t v = 0; v < 3; ++v) {
      const int node = nodes[v];
      holds[0][v] = pressure[node] > least;
      holds[1][v] =
          holds[0][v] && most[node] > 0 && sticks_by(sizes[node], most[node], violation) > 0;
    }
    const auto at = [&](int i) { return Eigen::Vector3d(values_.col(nodes[i]).head<3>()); };
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    for (Part part : parts_of(holds)) {
      part.triangle = k;
      part.area = area * part.place.share();
      parts_.push_back(part);
    }
  }
}

OutputFields ContactSurface::fields_at(const Part &part, const Barycentric &at) const {
  const int degree = per_cell_ == 3 ? 1 : 2, *nodes = nodes_of(part.triangle);
  std::array<double, most_nodes> phi{};
  lagrange_values(2, degree, part.place.at(at), phi);
  Eigen::Matrix<double, rows, 1> sum = phi[0] * values_.col(nodes[0]);
  for (int i = 1; i < per_cell_; ++i)
    sum += phi[i] * values_.col(nodes[i]);
  OutputFields fields;
  fields.fill(none);
  std::copy_n(sum.data() + point, 3, fields.begin() + field::x);
  std::copy_n(sum.data() + moved, 3, fields.begin() + field::ux);
  fields[field::u] = sum[raised];
  fields[field::pressure] = sum[pressed] - pull_;
  fields[field::gap] = sum[open];
  fields[field::slip] = sum.segment<3>(slid).norm();
  fields[field::tangential] = sum.segment<3>(sheared).norm();
  fields[field::contact] = part.touches_sticks[0] ? 1 : 0;
  fields[field::stick] = part.touches_sticks[1] ? 1 : 0;
  return fields;
}

void ContactSurface::add_to(OutputLines &sums) const {
  for (const Part &part : parts_)
    add_simplex(
        2, part.area, [&](const Barycentric &at) { return fields_at(part, at); },
        [](const OutputFields &) { return 1.0; }, sums);
}

} // namespace rbvi
