#include "rbvi/contact/contact_area.hpp"
#include "rbvi/contact/named_outputs.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/element/output_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A part of a cell, from and to; empty: from == to.
struct Part {
  double from = 0, to = 0;
  bool has(double s) const { return s > from && s < to; }
};

/// Values at both ends of every cell: 2 x cells.
using EndValues = Matrix;

class Lines {
public:
  Lines(const Grid &grid, const FrictionBound &bound, double least);
  std::vector<ContactLine> cut() const;

private:
  bool has(const std::string &name) const {
    return std::ranges::find(grid_.of_nodes, name, &Field::name) != grid_.of_nodes.end();
  }
  /// A field at vertices, or one that is constant on cells.
  EndValues field(const std::string &name, double otherwise) const;
  /// A field at the middles of cells, `mean` where the grid has none.
  Matrix middles(const std::string &name, const Matrix &mean) const;
  EndValues sticks(const FrictionBound &bound) const;
  int node(Index end, Index cell) const { return grid_.cells[2 * cell + end]; }
  double length(Index cell) const {
    return (grid_.points.row(node(1, cell)) - grid_.points.row(node(0, cell))).norm();
  }
  /// An end of a cell, then the far end of the cell on its other side.
  NodesBeside beside(Index end, Index cell, const EndValues &values) const;
  Part zone(Index cell, const EndValues &inside, const EndValues &outside) const;
  Part between_slips(Index cell) const;
  Part stick(Index cell, const Part &contact) const;
  OutputFields fields_at(Index cell, double s) const;

  const Grid &grid_;
  Index cells_;
  Eigen::Matrix2Xi beside_; ///< of each end the cell on its other side, -1: none
  bool signed_;             ///< Nitsche's method: the last two are negative outside
  EndValues pressure_, gap_, shear_, slip_;
  EndValues in_contact_, sticks_;   ///< > 0 there, else 0
  Matrix moved_, u_middle_;         ///< components x nodes, x cells
  Matrix gap_middle_, slip_middle_; ///< 1 x cells
};

/// Of degree 2, from its values at 0, 1 and 1/2.
double along(double s, double first, double last, double middle) {
  return (1 - s) * first + s * last + 4 * s * (1 - s) * (middle - (first + last) / 2);
}

/// Where such a field is zero, whose values at 0 and 1 have different signs.
double zero_of(double first, double last, double middle) {
  const double c = 2 * (first + last - 2 * middle), b = last - first - c,
               q = -(b + std::copysign(std::sqrt(b * b - 4 * c * first), b)) / 2;
  const double root = first / q;
  return root > 0 && root < 1 ? root : q / c;
}

Lines::Lines(const Grid &grid, const FrictionBound &bound, double least)
    : grid_(grid), cells_(std::ssize(grid.cells) / 2),
      beside_(Eigen::Matrix2Xi::Constant(2, cells_, -1)), signed_(has("P_n")),
      pressure_(field("pressure", 0)), gap_(field("gap", none)),
      shear_(field("tangential_stress", 0)), slip_(field("slip", none)) {
  std::vector<std::vector<Index>> at_node(grid.points.rows()); // ends, 2 cell + end
  for (Index end = 0; end < 2 * cells_; ++end)
    at_node[grid.cells[end]].push_back(end);
  for (const std::vector<Index> &ends : at_node)
    for (const Index one : ends)
      for (const Index other : ends)
        if (one / 2 != other / 2) beside_(one) = static_cast<int>(other / 2);
  const auto u = std::ranges::find(grid.of_nodes, "u", &Field::name);
  moved_ = u->values.reshaped(3, grid.points.rows());
  Matrix mean(3, cells_);
  for (Index k = 0; k < cells_; ++k)
    mean.col(k) = (moved_.col(node(0, k)) + moved_.col(node(1, k))) / 2;
  u_middle_ = middles("u_middle", mean);
  gap_middle_ = middles("gap_middle", gap_.colwise().mean());
  slip_middle_ = middles("slip_middle", slip_.colwise().mean());
  in_contact_ = (pressure_.array() > least).select(pressure_, 0);
  if (signed_) in_contact_ = -field("P_n", 0);
  sticks_ = sticks(bound);
}

EndValues Lines::sticks(const FrictionBound &bound) const {
  const EndValues shear = signed_ ? field("P_tau", 0) : shear_,
                  most = in_contact_.unaryExpr([&](double p) { return bound.value(p); });
  const double violation = friction_violation(shear.reshaped(), most.reshaped());
  EndValues result = EndValues::Zero(2, cells_);
  for (Index i = 0; i < result.size(); ++i)
    if (in_contact_(i) > 0 && most(i) > 0)
      result(i) = signed_ ? most(i) - std::abs(shear(i)) : sticks_by(shear(i), most(i), violation);
  return result;
}

EndValues Lines::field(const std::string &name, double otherwise) const {
  const auto find = [&](const std::vector<Field> &fields) {
    return std::ranges::find(fields, name, &Field::name);
  };
  if (const auto found = find(grid_.of_cells); found != grid_.of_cells.end())
    return found->values.transpose().replicate(2, 1);
  if (const auto found = find(grid_.of_nodes); found != grid_.of_nodes.end())
    return found->values(grid_.cells).reshaped(2, cells_);
  return EndValues::Constant(2, cells_, otherwise);
}

Matrix Lines::middles(const std::string &name, const Matrix &mean) const {
  const auto found = std::ranges::find(grid_.of_cells, name, &Field::name);
  if (found == grid_.of_cells.end()) return mean;
  return found->values.reshaped(mean.rows(), cells_);
}

NodesBeside Lines::beside(Index end, Index cell, const EndValues &values) const {
  const int next = beside_(end, cell);
  if (next < 0) return {{values(end, cell), none}, none};
  const Index far = node(0, next) == node(end, cell) ? 1 : 0;
  return {{values(end, cell), values(far, next)}, length(next)};
}

/// Of contact or stick, which ends where `inside` is not positive.
Part Lines::zone(Index cell, const EndValues &inside, const EndValues &outside) const {
  const bool first = inside(0, cell) > 0;
  if (first == (inside(1, cell) > 0)) return {0, first ? 1.0 : 0.0};
  const Index in = first ? 0 : 1;
  double share = inside(in, cell) / (inside(in, cell) - inside(1 - in, cell));
  if (!signed_) {
    const auto is_in = inside.array() > 0;
    const double whole = length(cell);
    share = way_into_edge(beside(in, cell, is_in.select(inside, none)),
                          beside(1 - in, cell, is_in.select(none, outside)), whole) /
            whole;
  }
  return first ? Part{0, share} : Part{1 - share, 1};
}

/// Both ends slip, in opposite directions: what sticks in between.
Part Lines::between_slips(Index cell) const {
  const auto slips = [&](Index end) {
    const double sign = slip_(end, cell) > 0 ? 1 : -1;
    return way_to_zone(beside(end, cell, sign * slip_)) / length(cell);
  };
  const double first = slips(0), last = slips(1);
  return first + last < 1 ? Part{first, 1 - last} : Part{};
}

Part Lines::stick(Index cell, const Part &contact) const {
  const bool sticks = (sticks_.col(cell).array() > 0).any();
  if (contact.from > 0 || contact.to < 1) return sticks ? contact : Part{};
  if (!sticks)
    return !signed_ && slip_.col(cell).prod() < 0 && shear_.col(cell).prod() < 0
               ? between_slips(cell)
               : Part{};
  const double held = slip_(sticks_(0, cell) > 0 ? 0 : 1, cell); // before, with a history
  return zone(cell, sticks_, (slip_.array() - held).abs().matrix());
}

OutputFields Lines::fields_at(Index cell, double s) const {
  OutputFields fields;
  fields.fill(none);
  const auto linear = [&](double first, double last) { return (1 - s) * first + s * last; };
  const auto of = [&](const EndValues &values) { return linear(values(0, cell), values(1, cell)); };
  const auto bent = [&](const EndValues &ends, const Matrix &middle) {
    return along(s, ends(0, cell), ends(1, cell), middle(0, cell));
  };
  const Index a = node(0, cell), b = node(1, cell);
  fields[field::x] = linear(grid_.points(a, 0), grid_.points(b, 0));
  fields[field::y] = linear(grid_.points(a, 1), grid_.points(b, 1));
  fields[field::ux] = along(s, moved_(0, a), moved_(0, b), u_middle_(0, cell));
  fields[field::uy] = along(s, moved_(1, a), moved_(1, b), u_middle_(1, cell));
  fields[field::pressure] = of(pressure_);
  fields[field::gap] = bent(gap_, gap_middle_);
  fields[field::tangential] = of(shear_);
  fields[field::slip] = bent(slip_, slip_middle_);
  return fields;
}

std::vector<ContactLine> Lines::cut() const {
  std::vector<ContactLine> lines;
  for (Index k = 0; k < cells_; ++k) {
    const Part contact = zone(k, in_contact_, gap_), sticks = stick(k, contact);
    std::vector<double> cuts{0, contact.from, contact.to, sticks.from, sticks.to, 1};
    if (const double a = shear_(0, k), b = shear_(1, k); a * b < 0) cuts.push_back(a / (a - b));
    if (const double a = slip_(0, k), b = slip_(1, k); a * b < 0)
      cuts.push_back(zero_of(a, b, slip_middle_(0, k)));
    std::ranges::sort(cuts);
    const bool first = in_contact_(0, k) > 0, ends = first != (in_contact_(1, k) > 0);
    const Index inside = first ? 0 : 1;
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const double from = cuts[i - 1], to = cuts[i];
      if (!(to > from)) continue;
      const std::array<double, 3> places{from, to, (from + to) / 2};
      ContactLine line{
          {fields_at(k, places[0]), fields_at(k, places[1]), fields_at(k, places[2])}, {}, 0};
      const auto &[begin, end, middle] = line.fields;
      line.measure = std::hypot(end[field::x] - begin[field::x], end[field::y] - begin[field::y]);
      for (OutputFields &fields : line.fields) {
        fields[field::contact] = contact.has((from + to) / 2) ? 1 : 0;
        fields[field::stick] = sticks.has((from + to) / 2) ? 1 : 0;
      }
      line.seen = line.fields;
      for (std::size_t place = 0; ends && place < places.size(); ++place) {
        const double s = places[place], at = first ? contact.to : contact.from,
                     in = first ? (at - s) / at : (s - at) / (1 - at),
                     out = first ? (s - at) / (1 - at) : (at - s) / at;
        line.seen[place][field::pressure] = pressure_(inside, k) * std::max(0.0, in);
        line.seen[place][field::gap] =
            gap_(inside, k) * std::max(0.0, in) + gap_(1 - inside, k) * std::max(0.0, out);
      }
      lines.push_back(line);
    }
  }
  return lines;
}

} // namespace

std::vector<ContactLine> contact_lines(const Grid &grid, const FrictionBound &bound, double least) {
  std::vector<ContactLine> lines = Lines(grid, bound, least).cut();
  for (ContactLine &line : lines)
    for (auto *places : {&line.fields, &line.seen})
      for (OutputFields &fields : *places)
        fields[field::pressure] -= bound.pull; // what multipliers count from
  return lines;
}

void add_lines(const std::vector<ContactLine> &lines, bool turned, OutputLines &sums) {
  const auto on = [&](std::array<OutputFields, 3> ContactLine::*fields) {
    return [&lines, fields](std::size_t line, double s) {
      const auto &[first, last, middle] = lines[line].*fields;
      OutputFields at;
      for (std::size_t i = 0; i < at.size(); ++i)
        at[i] = along(s, first[i], last[i], middle[i]);
      return at;
    };
  };
  sums.add(lines.size(), on(&ContactLine::fields), on(&ContactLine::seen),
           [&](std::size_t line, const OutputFields &at) {
             return lines[line].measure * circumference(turned, {at[field::x], 0, 0});
           });
}

} // namespace rbvi
