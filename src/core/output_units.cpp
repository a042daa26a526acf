#include "rbvi/core/output_units.hpp"

#include <algorithm>

namespace rbvi {

namespace {

const OutputForm *form_of(const Scene &scene, const OutputColumn &column) {
  if (column.value != nullptr) return nullptr;
  const auto found = std::ranges::find(scene.outputs, column.name, &OutputForm::name);
  return found == scene.outputs.end() ? nullptr : &*found;
}

} // namespace

Dimension size_of(const Scene &scene, Size size) {
  // Of a membrane all is whole, too.
  const bool whole = scene.axisymmetric || scene.components == 1 || scene.dim == 3;
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
  if (!scene.units) return "";
  return unit_in(*scene.units, size_of(scene, column.size));
}

std::string says_of(const Scene &scene, const OutputColumn &column) {
  const OutputForm *form = form_of(scene, column);
  return form != nullptr && !form->says.empty() ? form->says : column.says;
}

} // namespace rbvi
