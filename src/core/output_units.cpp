#include "rbvi/core/output_units.hpp"

#include <algorithm>
#include <map>

namespace rbvi {

namespace {

Size size_of_column(std::optional<double> Outputs::*value) {
  using enum Size;
  static const std::vector<std::pair<std::optional<double> Outputs::*, Size>> sizes{
      {&Outputs::energy, energy},
      {&Outputs::normal_force, force},
      {&Outputs::tangential_force, force},
      {&Outputs::reaction, force},
      {&Outputs::horizontal_reaction, force},
      {&Outputs::contact_measure, area},
      {&Outputs::contact_half_width, length},
      {&Outputs::stick_half_width, length},
      {&Outputs::peak_pressure, pressure},
      {&Outputs::centre_pressure, pressure},
      {&Outputs::min_u, length},
      {&Outputs::max_penetration, length},
      {&Outputs::friction_violation, pressure}};
  const auto found =
      std::ranges::find(sizes, value, &std::pair<std::optional<double> Outputs::*, Size>::first);
  return found == sizes.end() ? none : found->second;
}

const OutputForm *form_of(const Scene &scene, const OutputColumn &column) {
  if (column.value != nullptr) return nullptr;
  const auto found = std::ranges::find(scene.outputs, column.name, &OutputForm::name);
  return found == scene.outputs.end() ? nullptr : &*found;
}

} // namespace

Dimension size_of(const Scene &scene, Size size) {
  const bool whole = scene.axisymmetric || scene.components == 1; // of a membrane all is
  switch (size) {
  case Size::none:
    return {};
  case Size::energy:
    return {whole ? 1 : 0, 1, 0, 0};
  case Size::force:
    return {whole ? 0 : -1, 1, 0, 0};
  case Size::area:
    return {whole ? 2 : 1, 0, 0, 0};
  case Size::length:
    return {1, 0, 0, 0};
  case Size::pressure:
    return {-2, 1, 0, 0};
  }
  return {};
}

std::string unit_of(const Scene &scene, const OutputColumn &column) {
  if (const OutputForm *form = form_of(scene, column)) return form->unit;
  if (!scene.units || column.value == nullptr) return "";
  return unit_in(*scene.units, size_of(scene, size_of_column(column.value)));
}

std::string says_of(const Scene &scene, const OutputColumn &column) {
  const OutputForm *form = form_of(scene, column);
  return form != nullptr && !form->says.empty() ? form->says : column.says;
}

} // namespace rbvi
