#include "surface_lines.hpp"

#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A line across a triangle, from and to barycentric coordinates.
struct Across {
  std::array<std::array<double, 4>, 2> ends;
  double share; ///< of the area of the triangle, that it stands for
  std::array<double, 4> at(double s) const {
    std::array<double, 4> point{};
    for (std::size_t i = 0; i < 3; ++i)
      point[i] = (1 - s) * ends[0][i] + s * ends[1][i];
    return point;
  }
};

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
    touches_ = (pressed.array() > least).select(Vector::Ones(pressed.size()), -1);
    sticks_ = touches_;
    for (Index i = 0; i < sticks_.size(); ++i)
      if (!(most[i] > 0 && sticks_by(sizes[i], most[i], violation) > 0)) sticks_[i] = -1;
  }

  void add_lines(Index triangle, const std::vector<Across> &across,
                 std::vector<ContactLine> &lines) const {
    const int *nodes = grid_.cells.data() + triangle * grid_.per_cell;
    const auto at = [&](int i) { return Eigen::Vector3d(points_.col(nodes[i])); };
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    for (const Across &line : across) {
      std::vector<double> cuts{0, 1};
      for (const Vector *level : {&touches_, &sticks_}) {
        const double a = level_at(*level, nodes, line.at(0)),
                     b = level_at(*level, nodes, line.at(1));
        if (a * b < 0) cuts.push_back(a / (a - b));
      }
      std::ranges::sort(cuts);
      for (std::size_t i = 1; i < cuts.size(); ++i) {
        const double from = cuts[i - 1], to = cuts[i], middle = (from + to) / 2;
        if (!(to > from)) continue;
        ContactLine part{{fields_at(nodes, line.at(from)), fields_at(nodes, line.at(to)),
                          fields_at(nodes, line.at(middle))},
                         {},
                         (to - from) * line.share * area};
        for (OutputFields &fields : part.fields) {
          fields[field::contact] = level_at(touches_, nodes, line.at(middle)) > 0 ? 1 : 0;
          fields[field::stick] = level_at(sticks_, nodes, line.at(middle)) > 0 ? 1 : 0;
        }
        part.seen = part.fields;
        lines.push_back(part);
      }
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
  /// Linear between the vertices.
  static double level_at(const Vector &level, const int *nodes, const std::array<double, 4> &at) {
    return at[0] * level[nodes[0]] + at[1] * level[nodes[1]] + at[2] * level[nodes[2]];
  }
  OutputFields fields_at(const int *nodes, const std::array<double, 4> &at) const {
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
  Vector touches_, sticks_; ///< 1 or -1 at each node
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
