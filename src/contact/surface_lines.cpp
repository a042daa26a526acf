#include "surface_lines.hpp"

#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Barycentric = std::array<double, 4>;

/// A line across a triangle, from and to barycentric coordinates.
struct Across {
  std::array<Barycentric, 2> ends;
  double share; ///< of the area of the triangle, that it stands for
};

/// A triangle, or the part of one that is beside one of its vertices, or between these parts.
struct TrianglePart {
  std::array<Barycentric, 3> corners;
  double share;                    ///< of the area of the triangle
  std::array<bool, 2> of_vertices; ///< whether it touches, and sticks
  Barycentric at(const Barycentric &own) const {
    Barycentric point{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        point[i] += own[k] * corners[k][i];
    return point;
  }
};

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
std::vector<TrianglePart> parts_of(const VertexStates &holds) {
  const auto count = [](const std::array<bool, 3> &of) { return std::ranges::count(of, true); };
  const std::array<std::ptrdiff_t, 2> counts{count(holds[0]), count(holds[1])};
  const std::array<bool, 2> most{counts[0] > 1, counts[1] > 1};
  if (std::ranges::all_of(counts, [](std::ptrdiff_t of) { return of % 3 == 0; }))
    return {{{between(0, 0), between(1, 1), between(2, 2)}, 1, most}};
  std::vector<TrianglePart> parts{{{between(0, 1), between(1, 2), between(2, 0)}, 0.25, most}};
  for (std::size_t v = 0; v < 3; ++v)
    parts.push_back({{between(v, v), between(v, (v + 1) % 3), between(v, (v + 2) % 3)},
                     0.25,
                     {holds[0][v], holds[1][v]}});
  return parts;
}

/// Gauss's lines from the edges at the first vertex to each other, then the edges.
std::vector<Across> lines_across() {
  const double away = std::sqrt(0.15);
  std::vector<Across> lines;
  for (const auto &[r, weight] :
       {std::pair{0.5 - away, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + away, 5.0 / 18}})
    lines.push_back({{{{1 - r, r, 0, 0}, {1 - r, 0, r, 0}}}, 2 * r * weight});
  for (std::size_t i = 0; i < 3; ++i) {
    Across &edge = lines.emplace_back(Across{{}, 0});
    edge.ends[0][i] = edge.ends[1][(i + 1) % 3] = 1;
  }
  return lines;
}

/// A grid of triangles with its fields; what is not there is NaN.
class Triangles {
public:
  Triangles(const Grid &grid, const FrictionBound &bound, double least)
      : grid_(grid), degree_(grid.per_cell == 3 ? 1 : 2), points_(grid.points.transpose()),
        u_(field("u", 3)), slip_(field("slip", 3)), shear_(field("tangential_stress", 3)),
        pressure_(field("pressure", 1)), gap_(field("gap", 1)) {
    const Vector pressed = pressure_.row(0).transpose(),
                 sizes = shear_.array().isNaN().any() ? Vector(Vector::Zero(pressed.size()))
                                                      : Vector(shear_.colwise().norm());
    const Vector most = pressed.unaryExpr([&](double p) { return bound.value(p); });
    const double violation = friction_violation(sizes, most);
    for (Index i = 0; i < pressed.size(); ++i) {
      touches_.push_back(pressed[i] > least);
      sticks_.push_back(touches_.back() && most[i] > 0 &&
                        sticks_by(sizes[i], most[i], violation) > 0);
    }
  }

  void add_lines(Index triangle, const std::vector<Across> &across,
                 std::vector<ContactLine> &lines) const {
    const int *nodes = grid_.cells.data() + triangle * grid_.per_cell;
    const auto at = [&](int i) { return Eigen::Vector3d(points_.col(nodes[i])); };
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    VertexStates holds;
    for (std::size_t v = 0; v < 3; ++v) {
      holds[0][v] = touches_[nodes[v]];
      holds[1][v] = sticks_[nodes[v]];
    }
    for (const TrianglePart &part : parts_of(holds))
      for (const auto &[ends, share] : across) {
        const Barycentric from = part.at(ends[0]), to = part.at(ends[1]);
        Barycentric middle{};
        for (std::size_t i = 0; i < 3; ++i)
          middle[i] = (from[i] + to[i]) / 2;
        ContactLine line{{fields_at(nodes, from), fields_at(nodes, to), fields_at(nodes, middle)},
                         {},
                         share * part.share * area};
        for (OutputFields &fields : line.fields) {
          fields[field::contact] = part.of_vertices[0] ? 1 : 0;
          fields[field::stick] = part.of_vertices[1] ? 1 : 0;
        }
        line.seen = line.fields;
        lines.push_back(line);
      }
  }

private:
  /// Components x nodes.
  Matrix field(const std::string &name, Index components) const {
    const auto found = std::ranges::find(grid_.of_nodes, name, &Field::name);
    if (found == grid_.of_nodes.end())
      return Matrix::Constant(components, grid_.points.rows(), none);
    return found->values.reshaped(components, grid_.points.rows());
  }
  OutputFields fields_at(const int *nodes, const Barycentric &at) const {
    std::array<double, most_nodes> phi{};
    lagrange_values(2, degree_, at, phi);
    const auto of = [&](const Matrix &values) {
      Vector sum = Vector::Zero(values.rows());
      for (int i = 0; i < grid_.per_cell; ++i)
        sum += phi[i] * values.col(nodes[i]);
      return sum;
    };
    OutputFields fields;
    fields.fill(none);
    const Vector x = of(points_), u = of(u_);
    std::copy_n(x.begin(), 3, fields.begin() + field::x);
    std::copy_n(u.begin(), 3, fields.begin() + field::ux);
    fields[field::pressure] = of(pressure_)[0];
    fields[field::gap] = of(gap_)[0];
    fields[field::slip] = of(slip_).norm();
    const double shear = of(shear_).norm();
    fields[field::tangential] = std::isnan(shear) ? 0 : shear;
    return fields;
  }

  const Grid &grid_;
  int degree_;
  Matrix points_, u_, slip_, shear_, pressure_, gap_;
  std::vector<bool> touches_, sticks_; ///< at each node
};

} // namespace

std::vector<ContactLine> surface_lines(const Grid &grid, const FrictionBound &bound, double least) {
  const std::vector<Across> across = lines_across();
  const Triangles triangles(grid, bound, least);
  std::vector<ContactLine> lines;
  for (Index k = 0; k < std::ssize(grid.cells) / grid.per_cell; ++k)
    triangles.add_lines(k, across, lines);
  return lines;
}

} // namespace rbvi
