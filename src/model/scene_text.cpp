#include "rbvi/model/scene_text.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/model/scene_record.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

namespace rbvi {

namespace {

constexpr int draws = 16;
constexpr std::size_t most_values = 900;     ///< of a kernel
constexpr const char *of_values = " values"; ///< how the name of a line with a sum ends

/// Where functions are asked.
struct Draw {
  FullMu mu;
  Point x;             ///< reference domain
  Cell cell;           ///< about x
  double of_parameter; ///< between 0 and 1
};

/// Between 0 and 1, the same on every machine.
class Random {
public:
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

private:
  std::mt19937_64 engine_{42};
};

/// Values that a user chooses, the box among them, do not count: samples at other mu are the same.
double in_range(const Range &valid, double t) {
  const bool below = std::isfinite(valid.lower), above = std::isfinite(valid.upper);
  if (below && above) return valid.lower + t * (valid.upper - valid.lower);
  return below ? valid.lower + t : above ? valid.upper - t : t;
}

double extent_of(const Contact &contact) {
  double largest = 0;
  for (const auto &interface : contact.interfaces)
    for (const Point &x : interface->mesh().points)
      for (const double coordinate : x)
        largest = std::max(largest, std::abs(coordinate));
  return largest > 0 ? largest : 1;
}

Point random_point(int dim, double extent, Random &random) {
  Point x{};
  for (int c = 0; c < dim; ++c)
    x[c] = extent * (2 * random() - 1);
  return x;
}

/// Mapped where the map can.
Cell random_cell(const Scene &scene, const FullMu &mu, const Point &x, double size,
                 Random &random) {
  Cell cell{scene.dim, {}, {}};
  for (int v = 0; v <= scene.dim; ++v)
    cell.reference[v] = x + random_point(scene.dim, size, random);
  if (volume_of(cell.dim, cell.reference) < 0) std::swap(cell.reference[0], cell.reference[1]);
  cell.mapped = cell.reference;
  try {
    std::ranges::transform(cell.reference, cell.mapped.begin(),
                           [&](const Point &vertex) { return scene.map(mu, vertex); });
  } catch (const std::exception &) {
    return cell;
  }
  return cell;
}

std::vector<Draw> draws_of(const Scene &scene, const Contact &contact) {
  const double extent = 1.5 * extent_of(contact);
  Random random;
  std::vector<Draw> result;
  for (int k = 0; k < draws; ++k) {
    Draw draw{};
    for (const Parameter &p : scene.parameters.all)
      draw.mu.push_back(in_range(p.valid, random()));
    draw.x = random_point(scene.dim, extent, random);
    draw.cell = random_cell(scene, draw.mu, draw.x, 0.2 * extent, random);
    draw.of_parameter = random();
    result.push_back(std::move(draw));
  }
  return result;
}

/// Adds what a function returns to `values`.
using Evaluate = std::function<void(const Draw &, std::vector<double> &values)>;

class Text {
public:
  Text(const Scene &scene, const Contact &contact) : draws_(draws_of(scene, contact)) {}

  void add(const std::string &name, const std::string &what) {
    text_ << name << ": " << what << '\n';
  }
  void add(const std::string &name, const Record &record) {
    for (const auto &[path, value] : lines_of(record))
      add(path.empty()                       ? name
          : path[0] == ':' || path[0] == '=' ? name + path
                                             : name + "." + path,
          value);
  }
  /// A weighted sum of all values, and of how many draws they are, where some have none.
  void add_values(const std::string &name, const Evaluate &evaluate);
  void add_values(const std::string &name, const std::function<PointMap> &map) {
    if (map)
      add_values(name, [&](const Draw &at, std::vector<double> &values) {
        const Point y = map(at.mu, at.x);
        values.assign(y.begin(), y.end());
      });
  }
  std::string str() const { return text_.str(); }

private:
  std::vector<Draw> draws_;
  std::ostringstream text_;
};

void Text::add_values(const std::string &name, const Evaluate &evaluate) {
  Random weight;
  double sum = 0, terms = 0;
  int answered = 0;
  for (const Draw &draw : draws_) {
    std::vector<double> values;
    try {
      evaluate(draw, values);
    } catch (const std::exception &) { // makes no sense there
      continue;
    }
    double of_draw = 0;
    for (double &value : values) {
      value *= 0.5 + weight();
      of_draw += value;
    }
    if (!std::isfinite(of_draw)) continue;
    sum += of_draw;
    for (const double value : values)
      terms += std::abs(value);
    ++answered;
  }
  if (std::abs(sum) <= 1e-9 * terms) sum = 0; // round-off
  add(name + of_values,
      formatted("%.9g", sum) + (answered == draws ? "" : " of " + std::to_string(answered)));
}

void add_parameters(const Scene &scene, Text &text) {
  for (const Parameter &p : scene.parameters.all)
    text.add("parameter " + p.name, describe(p.valid));
  for (const auto &[parameter, coordinate] : scene.coordinates)
    text.add_values(
        "coordinate of " + scene.parameters.all.at(parameter).name,
        [&](const Draw &at, std::vector<double> &values) {
          values = {coordinate.of(at.mu.at(parameter)), coordinate.back(at.of_parameter)};
        });
}

void add_factors(const std::string &name, const std::vector<Factor> &factors, Text &text) {
  for (const Factor &factor : factors) {
    const std::string own = name + ", " + factor.name;
    text.add_values(own, [&](const Draw &at, std::vector<double> &values) {
      values.push_back(factor.value(at.mu));
    });
  }
}

/// The kernel of a form: rows, or rows x rows values.
void add_kernel(const std::string &name, const Scene &scene, const Form &form, bool bilinear,
                Text &text) {
  if (!form.kernel) return;
  const int dim = form.boundary.empty() ? scene.dim : scene.dim - 1;
  const auto rows = static_cast<std::size_t>(nodes_per_cell(dim, scene.degree) * scene.components);
  text.add_values(
      name, [&, size = bilinear ? rows * rows : rows](const Draw &at, std::vector<double> &values) {
        values.assign(most_values, 0);
        form.kernel(at.mu, at.cell, values.data());
        values.resize(size);
      });
}

void add_sum(const std::string &name, const Scene &scene, const Sum &sum, bool bilinear,
             Text &text) {
  int number = 0;
  for (const Term &term : sum) {
    if (term.of_imposed) continue; // made of the imposed values and of a
    const std::string own = name + "_" + std::to_string(number++);
    for (const Mean &mean : term.form.means)
      text.add(own + " mean of '" + mean.boundary + "'",
               shortest_number(mean.direction[0]) + ' ' + shortest_number(mean.direction[1]));
    if (term.theta && term.form.kernel) {
      text.add(own + ".kernel", term.form.kernel.record);
      text.add(own + " over", term.form.region + term.form.boundary);
      if (!term.form.without.empty()) text.add(own + " not over", joined(term.form.without));
    }
    add_kernel(own, scene, term.form, bilinear, text);
    if (term.theta) add_factors(own, *term.theta, text);
  }
}

void add_fixed(const Scene &scene, Text &text) {
  for (const TiedBoundary &tied : scene.tied)
    text.add("tied " + std::to_string(tied.component), tied.name);
  for (std::size_t b = 0; b < scene.fixed.size(); ++b) {
    const FixedBoundary &boundary = scene.fixed[b];
    const std::string name = "fixed_" + std::to_string(b);
    std::vector<std::string> components;
    for (const int c : boundary.components)
      components.push_back(std::to_string(c));
    text.add(name, boundary.name + " " + (components.empty() ? "all" : joined(components)));
    int number = 0;
    for (const ImposedTerm &term : boundary.values) {
      const std::string own = name + "_" + std::to_string(number++);
      text.add_values(own, term.value);
      if (term.theta) add_factors(own, *term.theta, text);
    }
  }
}

void add_contact(const Scene &scene, const Contact &contact, Text &text) {
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const ContactInterface &interface = *contact.interfaces[i];
    const std::string own = "contact_" + std::to_string(i);
    for (const ContactCoefficient &coefficient : scene.contacts[i].coefficients)
      text.add_values(own + ", " + coefficient.name,
                      [&](const Draw &at, std::vector<double> &values) {
                        values.push_back(coefficient.value(at.mu));
                      });
    text.add_values(own, [&](const Draw &at, std::vector<double> &values) {
      const PointConstraint there = interface.constraint_at(at.mu, at.x);
      values = {there.direction[0], there.direction[1], there.direction[2], there.gap};
    });
  }
}

void add_mesh(const Scene &scene, Text &text) {
  const MeshRecipe &mesh = scene.mesh;
  for (const auto &[name, list] :
       {std::pair{"regions", &mesh.regions}, {"boundaries", &mesh.boundaries}})
    if (!list->empty()) text.add(std::string("mesh ") + name, joined(*list));
  for (const MeshFact &fact : mesh.facts) {
    const std::string own = "mesh '" + fact.part + "'";
    text.add(own + " size", shortest_number(fact.size));
    if (fact.distance)
      text.add_values(own, [&](const Draw &at, std::vector<double> &values) {
        values.push_back(fact.distance(at.x));
      });
  }
  for (const auto &[name, curve] : scene.curves)
    text.add_values("curve of '" + name + "'", [&](const Draw &at, std::vector<double> &values) {
      const Point y = curve(at.x);
      values.assign(y.begin(), y.end());
    });
}

using Lines = std::vector<std::pair<std::string, std::string>>;

Lines lines_in(const std::string &text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    lines.emplace_back(line.substr(0, colon),
                       colon == std::string::npos ? "" : line.substr(colon + 2));
  }
  return lines;
}

bool same(const std::string &name, const std::string &one, const std::string &other) {
  if (one == other) return true;
  if (!name.ends_with(of_values)) return false;
  char *rest = nullptr, *other_rest = nullptr;
  const double a = std::strtod(one.c_str(), &rest), b = std::strtod(other.c_str(), &other_rest);
  return std::string(rest) == other_rest &&
         std::abs(a - b) <= 1e-8 * std::max(std::abs(a), std::abs(b));
}

} // namespace

std::string scene_text(const Scene &scene, const Contact &contact) {
  Text text(scene, contact);
  add_parameters(scene, text);
  Scene without_outputs = scene; // which change no answer
  without_outputs.outputs.clear();
  Record record = record_of(without_outputs);
  record.name = "scene";         // whatever its folder is called
  record.parts.erase("check");   // refuses parameters, and changes no answer
  record.numbers.erase("small"); // nor does what warnings there are
  for (auto &[name, part] : record.parts)
    if (name.starts_with("contact_")) part.texts.erase("name"); // nor does what it is called
  text.add("scene", record);
  text.add_values("map", scene.map);
  text.add_values("motion", scene.motion);
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    text.add_values("material_" + std::to_string(m),
                    [&](const Draw &at, std::vector<double> &values) {
                      const auto [lambda, shear] = scene.materials[m].of_cell(at.mu, at.x);
                      values = {lambda, shear};
                      if (scene.materials[m].free_strain)
                        values.push_back(scene.materials[m].free_strain(at.mu, at.x));
                    });
  add_fixed(scene, text);
  add_contact(scene, contact, text);
  add_sum("a", scene, scene.a, true, text);
  add_sum("f", scene, scene.f, false, text);
  add_sum("v_product", scene, scene.v_product, true, text);
  add_mesh(scene, text);
  return text.str();
}

std::string scene_difference(const std::string &theirs, const std::string &mine, Further further) {
  const Lines before = lines_in(theirs), now = lines_in(mine);
  const auto value_in = [](const Lines &lines, const std::string &name) -> std::string {
    const auto found = std::ranges::find(lines, name, &Lines::value_type::first);
    return found == lines.end() ? "not there" : found->second;
  };
  for (const auto &[name, value] : now)
    if (const std::string old = value_in(before, name); !same(name, old, value))
      return name + " is " + value + ", it was " + old;
  for (const auto &[name, value] : before)
    if (further == Further::refused && value_in(now, name) == "not there")
      return name + " was " + value + " and is gone";
  return "";
}

} // namespace rbvi
