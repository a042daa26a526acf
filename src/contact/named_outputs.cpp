#include "rbvi/contact/named_outputs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace rbvi {

namespace {

/// In the order of output_fields().
constexpr Index of_u = 2, of_pressure = 4, of_gap = 5, of_tangential = 6, places = 7;

/// Fields at both ends of each piece of an interface, a column each.
struct Traces {
  Matrix at; ///< places x (2 pieces)
  Index pieces() const { return at.cols() / 2; }
};

/// Of a field at vertices, or one that is constant on pieces; NaN where the grid has none of this
/// name.
Vector at_ends(const Grid &grid, const std::string &name) {
  const auto named = [&](const std::vector<Field> &fields) {
    return std::ranges::find(fields, name, &Field::name);
  };
  const auto of_pieces = named(grid.of_cells);
  const auto of_nodes = named(grid.of_nodes);
  return Vector::NullaryExpr(std::ssize(grid.cells), [&](Index k) {
    if (of_pieces != grid.of_cells.end()) return of_pieces->values[k / 2];
    if (of_nodes != grid.of_nodes.end()) return of_nodes->values[grid.cells[k]];
    return std::numeric_limits<double>::quiet_NaN();
  });
}

Traces traces_of(const Grid &grid) {
  if (grid.per_cell != 2) throw bad_input("outputs of a case are over contact along curves");
  Traces traces{Matrix(places, std::ssize(grid.cells))};
  const auto moved = std::ranges::find(grid.of_nodes, "u", &Field::name);
  for (Index k = 0; k < traces.at.cols(); ++k) {
    const Index node = grid.cells[k];
    traces.at.col(k).head<2>() = grid.points.row(node).head<2>().transpose();
    traces.at.col(k).segment<2>(of_u) = moved->values.segment<2>(3 * node);
  }
  traces.at.row(of_pressure) = at_ends(grid, "pressure").transpose();
  traces.at.row(of_gap) = at_ends(grid, "gap").transpose();
  traces.at.row(of_tangential) = at_ends(grid, "tangential_stress").transpose();
  return traces;
}

/// The value and whether the condition holds, at points of the pieces.
class OnPieces {
public:
  OnPieces(const Named<FieldValues> &values, const FullMu &mu, const Traces &traces)
      : values_(values), mu_(mu), traces_(traces) {}

  Index pieces() const { return traces_.pieces(); }
  double length(Index piece) const {
    return (end(piece, 1).head<2>() - end(piece, 0).head<2>()).norm();
  }
  double abscissa(Index piece, double s) const {
    return (1 - s) * end(piece, 0)[0] + s * end(piece, 1)[0];
  }
  /// At 0 <= s <= 1 on a piece: value and condition.
  std::array<double, 2> at(Index piece, double s) const {
    const Vector fields = (1 - s) * end(piece, 0) + s * end(piece, 1);
    std::array<double, 2> result{0, 1};
    values_(mu_, fields.data(), result.data());
    return result;
  }
  bool holds(Index piece, double s) const { return at(piece, s)[1] != 0; }

  /// Calls use(from, to) for the parts of a piece on which the condition holds.
  template <class Use> void parts(Index piece, const Use &use) const {
    constexpr int samples = 8; // crossings closer to each other than that are not seen
    bool held = holds(piece, 0);
    double from = 0;
    for (int k = 1; k <= samples; ++k) {
      const double s = double(k) / samples;
      const bool now = holds(piece, s);
      if (now != held) {
        const double crossing = crossing_in(piece, double(k - 1) / samples, s);
        if (held) use(from, crossing);
        from = crossing;
        held = now;
      }
    }
    if (held) use(from, 1.0);
  }

private:
  Vector end(Index piece, Index which) const { return traces_.at.col(2 * piece + which); }
  double crossing_in(Index piece, double low, double high) const {
    const bool held = holds(piece, low);
    for (int step = 0; step < 50; ++step) {
      const double middle = (low + high) / 2;
      (holds(piece, middle) == held ? low : high) = middle;
    }
    return (low + high) / 2;
  }

  const Named<FieldValues> &values_;
  const FullMu &mu_;
  const Traces &traces_;
};

struct FormSums {
  double measure = 0, integral = 0;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
};

/// Three Gauss points on each part, of a length or (`turned` about x = 0) an area.
void add(const OnPieces &on, bool turned, FormSums &sums) {
  const double away = std::sqrt(0.15);
  const std::array<double, 3> points{0.5 - away, 0.5, 0.5 + away},
      weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
  for (Index piece = 0; piece < on.pieces(); ++piece)
    on.parts(piece, [&](double from, double to) {
      const double length = (to - from) * on.length(piece);
      for (std::size_t q = 0; q < 3; ++q) {
        const double s = from + (to - from) * points[q];
        const double weight =
            weights[q] * length * (turned ? 2 * std::numbers::pi * on.abscissa(piece, s) : 1);
        sums.measure += weight;
        sums.integral += weight * on.at(piece, s)[0];
      }
      for (const double s : {from, (from + to) / 2, to}) {
        const double value = on.at(piece, s)[0];
        sums.least = std::min(sums.least, value);
        sums.largest = std::max(sums.largest, value);
      }
    });
}

double value_of(const OutputForm &form, const FormSums &sums, double images) {
  switch (form.kind) {
  case OutputForm::Kind::integral:
    return images * sums.integral;
  case OutputForm::Kind::measure:
    return images * sums.measure;
  case OutputForm::Kind::mean:
    return sums.integral / sums.measure;
  case OutputForm::Kind::min:
    return sums.least;
  case OutputForm::Kind::max:
    return sums.largest;
  }
  return 0;
}

} // namespace

void check_outputs(const Scene &scene) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    names.push_back(contact_name(scene, i));
  for (const OutputForm &form : scene.outputs)
    for (const std::string &at : form.at)
      if (std::ranges::find(names, at) == names.end())
        throw bad_input("the output '" + form.name + "' is over '" + at +
                        "', which is no contact: the nearest is '" + nearest_name(at, names) + "'");
}

void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const InterfaceDisplacement &u, const Vector &lambda, Outputs &outputs) {
  outputs.named.clear();
  if (scene.outputs.empty()) return;
  std::vector<std::optional<Traces>> traces(contact.interfaces.size());
  for (const OutputForm &form : scene.outputs) {
    FormSums sums;
    for (std::size_t i = 0; i < traces.size(); ++i) {
      if (std::ranges::find(form.at, contact.names[i]) == form.at.end()) continue;
      ContactInterface &interface = *contact.interfaces[i];
      if (!traces[i])
        traces[i] = traces_of(interface.fields(
            mu, u(i), lambda.segment(contact.first_row[i], interface.dual().size())));
      add(OnPieces(form.values, mu, *traces[i]), scene.axisymmetric, sums);
    }
    const double value = value_of(form, sums, scene.mirror_images);
    if (!std::isfinite(value))
      throw failure("the output '" + form.name +
                    "' has no value: nothing is where its condition holds, or a field is not "
                    "there (tangential needs friction)");
    outputs.named.push_back({form.name, value});
  }
}

} // namespace rbvi
