#include "rbvi/contact/contact_lines.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rbvi {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A part of a cell; empty: from == to.
struct Part {
  double from = 0, to = 0;
  bool has(double s) const { return s > from && s < to; }
};

const Field *find_field(const std::vector<Field> &fields, const std::string &name) {
  const auto found = std::ranges::find(fields, name, &Field::name);
  return found == fields.end() ? nullptr : &*found;
}

/// Values are of the ends of cells: those of cell k are 2 k and 2 k + 1, the other end of i is i ^
/// 1.
class Lines {
public:
  Lines(const Grid &grid, const FrictionBound &bound, double least);
  std::vector<ContactLine> cut() const;

private:
  Vector field(const std::string &name, double otherwise) const;
  double length(Index cell) const {
    return (grid_.points.row(grid_.cells[2 * cell + 1]) - grid_.points.row(grid_.cells[2 * cell]))
        .norm();
  }
  template <class Holds>
  NodesBeside beside(Index end, const Vector &values, const Holds &holds) const;
  Part zone(Index cell, const Vector &inside, const Vector &outside) const;
  Part between_slips(Index cell) const;
  Part stick(Index cell, const Part &contact) const;
  OutputFields fields_at(Index cell, double s) const;
  void add(Index cell, Part part, const Part &contact, const Part &sticks,
           std::vector<ContactLine> &lines) const;

  const Grid &grid_;
  const bool signed_; ///< Nitsche's method: what is > 0 inside of a zone is < 0 outside, else 0
  Vector pressure_, gap_, shear_, slip_;
  Vector in_contact_, sticks_; ///< > 0 inside
  std::vector<Index> next_;    ///< the end of another cell at the same node, -1: none
};

Lines::Lines(const Grid &grid, const FrictionBound &bound, double least)
    : grid_(grid), signed_(find_field(grid.of_nodes, "P_n") != nullptr),
      pressure_(field("pressure", 0)), gap_(field("gap", none)),
      shear_(field("tangential_stress", 0)), slip_(field("slip", none)),
      in_contact_(signed_ ? Vector(-field("P_n", 0))
                          : Vector((pressure_.array() > least).select(pressure_, 0))),
      sticks_(Vector::Zero(pressure_.size())), next_(grid.cells.size(), -1) {
  std::vector<Index> last(grid.points.rows(), -1);
  for (Index i = 0; i < std::ssize(next_); ++i) {
    Index &other = last[grid.cells[i]];
    if (other >= 0) {
      next_[i] = other;
      next_[other] = i;
    }
    other = i;
  }
  const Vector shear = signed_ ? field("P_tau", 0) : shear_, bounds = values_of(bound, in_contact_);
  const double violation = signed_ ? 0 : friction_violation(shear, bounds);
  for (Index i = 0; i < sticks_.size(); ++i)
    if (in_contact_[i] > 0)
      sticks_[i] =
          signed_ ? bounds[i] - std::abs(shear[i]) : sticks_by(shear[i], bounds[i], violation);
}

/// At vertices, or constant on cells.
Vector Lines::field(const std::string &name, double otherwise) const {
  Vector values = Vector::Constant(std::ssize(grid_.cells), otherwise);
  const Field *of_cells = find_field(grid_.of_cells, name),
              *of_nodes = find_field(grid_.of_nodes, name);
  for (Index i = 0; i < values.size(); ++i)
    if (of_cells != nullptr)
      values[i] = of_cells->values[i / 2];
    else if (of_nodes != nullptr)
      values[i] = of_nodes->values[grid_.cells[i]];
  return values;
}

/// The node of an end and the next one beyond it, of which `holds` is asked.
template <class Holds>
NodesBeside Lines::beside(Index end, const Vector &values, const Holds &holds) const {
  const Index far = next_[end] < 0 ? -1 : next_[end] ^ 1;
  if (far < 0 || !holds(far)) return {{values[end], none}, none};
  return {{values[end], values[far]}, length(far / 2)};
}

Part Lines::zone(Index cell, const Vector &inside, const Vector &outside) const {
  const auto is_in = [&](Index end) { return inside[end] > 0; };
  const bool first = is_in(2 * cell), last = is_in(2 * cell + 1);
  if (first == last) return {0, first ? 1.0 : 0.0};
  const Index in = 2 * cell + (first ? 0 : 1), out = in ^ 1;
  const double whole = length(cell),
               share = signed_ ? inside[in] / (inside[in] - inside[out])
                               : way_into_edge(beside(in, inside, is_in),
                                               beside(out, outside, std::not_fn(is_in)), whole) /
                                     whole;
  return first ? Part{0, share} : Part{1 - share, 1};
}

/// Both ends slip, in opposite directions: what sticks in between.
Part Lines::between_slips(Index cell) const {
  const auto way = [&](Index end) {
    const Vector sizes = (slip_[end] > 0 ? 1 : -1) * slip_;
    return way_to_zone(beside(end, sizes, [](Index) { return true; })) / length(cell);
  };
  const double first = way(2 * cell), last = way(2 * cell + 1);
  return first + last < 1 ? Part{first, 1 - last} : Part{};
}

Part Lines::stick(Index cell, const Part &contact) const {
  const Index first = 2 * cell, last = first + 1;
  const bool sticks = sticks_[first] > 0 || sticks_[last] > 0;
  if (contact.to - contact.from < 1) return sticks ? contact : Part{};
  if (!sticks && !signed_ && slip_[first] * slip_[last] < 0 && shear_[first] * shear_[last] < 0)
    return between_slips(cell);
  const double held = slip_[sticks_[first] > 0 ? first : last]; // before, with a history
  return zone(cell, sticks_, (slip_.array() - held).abs());
}

OutputFields Lines::fields_at(Index cell, double s) const {
  OutputFields fields;
  fields.fill(none);
  const auto along = [&](double first, double last) { return (1 - s) * first + s * last; };
  const auto of = [&](const Vector &values) {
    return along(values[2 * cell], values[2 * cell + 1]);
  };
  const Vector &moved = find_field(grid_.of_nodes, "u")->values;
  const Index a = grid_.cells[2 * cell], b = grid_.cells[2 * cell + 1];
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

void Lines::add(Index cell, Part part, const Part &contact, const Part &sticks,
                std::vector<ContactLine> &lines) const {
  ContactLine line;
  const double middle = (part.from + part.to) / 2;
  for (const std::size_t end : {0, 1}) {
    const double s = end == 0 ? part.from : part.to;
    OutputFields &here = line.fields[end], &seen = line.seen[end];
    here = fields_at(cell, s);
    here[field::contact] = contact.has(middle) ? 1 : 0;
    here[field::stick] = sticks.has(middle) ? 1 : 0;
    seen = here;
    const bool from_first = in_contact_[2 * cell] > 0;
    if (from_first == (in_contact_[2 * cell + 1] > 0)) continue;
    const Index in = 2 * cell + (from_first ? 0 : 1);
    const double at_end = from_first ? contact.to : contact.from, last = from_first ? 0 : 1,
                 way = std::abs(s - last) / std::abs(at_end - last),
                 beyond = (s - at_end) / (1 - last - at_end);
    seen[field::pressure] = pressure_[in] * std::max(0.0, 1 - way);
    seen[field::gap] = gap_[in] * std::max(0.0, 1 - way) + gap_[in ^ 1] * std::max(0.0, beyond);
  }
  lines.push_back(line);
}

std::vector<ContactLine> Lines::cut() const {
  std::vector<ContactLine> lines;
  for (Index cell = 0; cell < std::ssize(next_) / 2; ++cell) {
    const Part contact = zone(cell, in_contact_, gap_), sticks = stick(cell, contact);
    std::vector<double> cuts{0, contact.from, contact.to, sticks.from, sticks.to, 1};
    for (const Vector *values : {&shear_, &slip_})
      if (const double a = (*values)[2 * cell], b = (*values)[2 * cell + 1]; a * b < 0)
        cuts.push_back(a / (a - b));
    std::ranges::sort(cuts);
    for (std::size_t i = 1; i < cuts.size(); ++i)
      if (cuts[i] > cuts[i - 1]) add(cell, {cuts[i - 1], cuts[i]}, contact, sticks, lines);
  }
  return lines;
}

} // namespace

std::vector<ContactLine> contact_lines(const Grid &grid, const FrictionBound &bound, double least) {
  if (grid.per_cell != 2) throw bad_input("outputs over contact are of curves");
  return Lines(grid, bound, least).cut();
}

} // namespace rbvi
