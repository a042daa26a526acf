#include "rbvi/contact/contact_lines.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// An end, 0 or 1, of a cell.
struct End {
  std::size_t cell, end;
  End other() const { return {cell, 1 - end}; }
};

/// A part of a cell, from and to; empty: from == to.
struct Part {
  double from = 0, to = 0;
  bool has(double s) const { return s > from && s < to; }
};

/// Values at both ends of every cell.
class EndValues {
public:
  EndValues() = default;
  EndValues(std::size_t cells, double value) : values_(cells, {value, value}) {}
  double &operator[](const End &at) { return values_[at.cell][at.end]; }
  double operator[](const End &at) const { return values_[at.cell][at.end]; }

private:
  std::vector<std::array<double, 2>> values_;
};

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
  void set_stick(const FrictionBound &bound);
  template <class Visit> void each_end(Visit &&visit) const {
    for (std::size_t k = 0; k < cells_; ++k)
      for (const std::size_t end : {0, 1})
        visit(End{k, end});
  }
  Index node(const End &at) const { return grid_.cells[2 * at.cell + at.end]; }
  double length(std::size_t cell) const {
    return (grid_.points.row(node({cell, 1})) - grid_.points.row(node({cell, 0}))).norm();
  }
  /// The far end of the cell on the other side of a node, NaN for its value where there is none
  /// or `holds` is not true of it.
  template <class Holds>
  NodesBeside beside(const End &at, const EndValues &values, const Holds &holds) const;
  Part zone(std::size_t cell, const EndValues &inside, const EndValues &outside) const;
  Part between_slips(std::size_t cell) const;
  Part stick(std::size_t cell, const Part &contact) const;
  OutputFields fields_at(std::size_t cell, double s) const;

  const Grid &grid_;
  std::size_t cells_;
  std::vector<std::array<int, 2>> beside_; ///< of each end the cell on its other side, -1: none
  EndValues pressure_, gap_, shear_, slip_;
  EndValues in_contact_; ///< > 0 in contact; by Nitsche's method < 0 out of it, else 0
  EndValues sticks_;     ///< > 0 where it sticks, likewise
  bool signed_ = false;  ///< they are negative outside
};

Lines::Lines(const Grid &grid, const FrictionBound &bound, double least)
    : grid_(grid), cells_(grid.cells.size() / 2), beside_(cells_, {-1, -1}),
      pressure_(field("pressure", 0)), gap_(field("gap", none)),
      shear_(field("tangential_stress", 0)), slip_(field("slip", none)), in_contact_(pressure_),
      signed_(has("P_n")) {
  std::vector<std::vector<End>> at_node(grid.points.rows());
  each_end([&](const End &at) { at_node[node(at)].push_back(at); });
  for (const std::vector<End> &ends : at_node)
    for (const End &one : ends)
      for (const End &other : ends)
        if (one.cell != other.cell) beside_[one.cell][one.end] = static_cast<int>(other.cell);
  const EndValues p_n = field("P_n", 0);
  each_end([&](const End &at) {
    double &value = in_contact_[at];
    value = signed_ ? -p_n[at] : value > least ? value : 0;
  });
  set_stick(bound);
}

void Lines::set_stick(const FrictionBound &bound) {
  sticks_ = EndValues(cells_, 0);
  const EndValues shear = signed_ ? field("P_tau", 0) : shear_;
  double violation = 0;
  each_end([&](const End &at) {
    violation = std::max(violation, std::abs(shear[at]) - bound.value(in_contact_[at]));
  });
  each_end([&](const End &at) {
    if (!(in_contact_[at] > 0) || !(bound.value(in_contact_[at]) > 0)) return;
    const double most = bound.value(in_contact_[at]);
    sticks_[at] = signed_ ? most - std::abs(shear[at]) : sticks_by(shear[at], most, violation);
  });
}

EndValues Lines::field(const std::string &name, double otherwise) const {
  EndValues values(cells_, otherwise);
  const auto find = [&](const std::vector<Field> &fields) {
    return std::ranges::find(fields, name, &Field::name);
  };
  if (const auto found = find(grid_.of_cells); found != grid_.of_cells.end())
    each_end([&](const End &at) { values[at] = found->values[static_cast<Index>(at.cell)]; });
  else if (const auto at_nodes = find(grid_.of_nodes); at_nodes != grid_.of_nodes.end())
    each_end([&](const End &at) { values[at] = at_nodes->values[node(at)]; });
  return values;
}

template <class Holds>
NodesBeside Lines::beside(const End &at, const EndValues &values, const Holds &holds) const {
  const int next = beside_[at.cell][at.end];
  if (next < 0) return {{values[at], none}, none};
  const auto cell = static_cast<std::size_t>(next);
  const End far{cell, node({cell, 0}) == node(at) ? std::size_t{1} : std::size_t{0}};
  return {{values[at], holds(far) ? values[far] : none}, length(cell)};
}

/// Of contact or stick, which ends where `inside` is not positive.
Part Lines::zone(std::size_t cell, const EndValues &inside, const EndValues &outside) const {
  const bool first = inside[{cell, 0}] > 0, last = inside[{cell, 1}] > 0;
  if (first == last) return {0, first ? 1.0 : 0.0};
  const End in{cell, first ? std::size_t{0} : std::size_t{1}}, out = in.other();
  double share = 0;
  if (signed_) {
    share = inside[in] / (inside[in] - inside[out]);
  } else {
    const auto is_in = [&](const End &at) { return inside[at] > 0; };
    const double whole = length(cell);
    share = way_into_edge(beside(in, inside, is_in),
                          beside(out, outside, [&](const End &at) { return !is_in(at); }), whole) /
            whole;
  }
  return first ? Part{0, share} : Part{1 - share, 1};
}

/// Both ends slip, in opposite directions: what sticks in between.
Part Lines::between_slips(std::size_t cell) const {
  const auto slips = [&](std::size_t end) {
    EndValues sizes(cells_, none);
    const double sign = slip_[{cell, end}] > 0 ? 1 : -1;
    each_end([&](const End &at) { sizes[at] = sign * slip_[at]; });
    return way_to_zone(beside({cell, end}, sizes, [](const End &) { return true; })) / length(cell);
  };
  const double first = slips(0), last = slips(1);
  return first + last < 1 ? Part{first, 1 - last} : Part{};
}

Part Lines::stick(std::size_t cell, const Part &contact) const {
  const End first{cell, 0}, last{cell, 1};
  const bool sticks = sticks_[first] > 0 || sticks_[last] > 0;
  if (contact.from > 0 || contact.to < 1) return sticks ? contact : Part{};
  if (!sticks)
    return !signed_ && slip_[first] * slip_[last] < 0 && shear_[first] * shear_[last] < 0
               ? between_slips(cell)
               : Part{};
  const double held = slip_[sticks_[first] > 0 ? first : last]; // before, with a history
  EndValues slips = slip_;
  each_end([&](const End &at) { slips[at] = std::abs(slips[at] - held); });
  return zone(cell, sticks_, slips);
}

OutputFields Lines::fields_at(std::size_t cell, double s) const {
  OutputFields fields;
  fields.fill(none);
  const auto along = [&](double first, double last) { return (1 - s) * first + s * last; };
  const auto of = [&](const EndValues &values) {
    return along(values[{cell, 0}], values[{cell, 1}]);
  };
  const Vector &moved = std::ranges::find(grid_.of_nodes, "u", &Field::name)->values;
  const Index a = node({cell, 0}), b = node({cell, 1});
  fields[field::x] = along(grid_.points(a, 0), grid_.points(b, 0));
  fields[field::y] = along(grid_.points(a, 1), grid_.points(b, 1));
  fields[field::ux] = along(moved[3 * a], moved[3 * b]);
  fields[field::uy] = along(moved[3 * a + 1], moved[3 * b + 1]);
  fields[field::pressure] = of(pressure_);
  fields[field::gap] = of(gap_);
  fields[field::tangential] = of(shear_);
  fields[field::slip] = of(slip_);
  return fields;
}

std::vector<ContactLine> Lines::cut() const {
  std::vector<ContactLine> lines;
  for (std::size_t k = 0; k < cells_; ++k) {
    const Part contact = zone(k, in_contact_, gap_), sticks = stick(k, contact);
    std::vector<double> cuts{0, contact.from, contact.to, sticks.from, sticks.to, 1};
    for (const EndValues *values : {&shear_, &slip_})
      if (const double a = (*values)[{k, 0}], b = (*values)[{k, 1}]; a * b < 0)
        cuts.push_back(a / (a - b));
    std::ranges::sort(cuts);
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const double from = cuts[i - 1], to = cuts[i];
      if (!(to > from)) continue;
      ContactLine line{{fields_at(k, from), fields_at(k, to)}, {}};
      for (OutputFields &fields : line.fields) {
        fields[field::contact] = contact.has((from + to) / 2) ? 1 : 0;
        fields[field::stick] = sticks.has((from + to) / 2) ? 1 : 0;
      }
      line.seen = line.fields;
      const bool first = in_contact_[{k, 0}] > 0;
      for (const std::size_t end : {0, 1}) {
        if (first == (in_contact_[{k, 1}] > 0)) continue;
        const double s = end == 0 ? from : to, at = first ? contact.to : contact.from,
                     in = first ? (at - s) / at : (s - at) / (1 - at),
                     out = first ? (s - at) / (1 - at) : (at - s) / at;
        const End inside{k, first ? std::size_t{0} : std::size_t{1}};
        line.seen[end][field::pressure] = pressure_[inside] * std::max(0.0, in);
        line.seen[end][field::gap] =
            gap_[inside] * std::max(0.0, in) + gap_[inside.other()] * std::max(0.0, out);
      }
      lines.push_back(line);
    }
  }
  return lines;
}

} // namespace

std::vector<ContactLine> contact_lines(const Grid &grid, const FrictionBound &bound, double least) {
  if (grid.per_cell != 2) throw bad_input("outputs over contact are of curves");
  return Lines(grid, bound, least).cut();
}

} // namespace rbvi
