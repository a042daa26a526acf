#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr std::array<const char *, 3> axes{"x", "y", "z"};

/// mirror_images: 2 and 4 are short for planes through the origin.
void read_mirrors(const Reader &reader, Scene &scene) {
  const CaseNode *planes = reader.root.find("mirror");
  const double images = number_or(reader, reader.root, "mirror_images", 1);
  if (images != 1 && images != 2 && images != 4)
    throw bad_input("mirror_images is " + short_number(images) +
                    ": 2 is short for mirror: {x: 0}, 4 for mirror: {x: 0, y: 0}");
  if (images > 1 && planes != nullptr)
    throw bad_input("mirror_images and mirror say the same: leave out mirror_images");
  for (int c = 0; c < scene.dim; ++c) {
    const CaseNode *position = planes == nullptr ? nullptr : planes->find(axes[c]);
    if (position != nullptr || (c < 2 && images > 2 * c + 1))
      scene.mirrors.push_back({c, position != nullptr ? number_in(reader, *position) : 0});
  }
  if (scene.axisymmetric && cancels(scene.mirrors, 0))
    throw bad_input("an axisymmetric body is whole about x = 0: leave out this plane of symmetry");
}

} // namespace

void read_symmetry(const Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode *images = reader.root.find("mirror_images");
  defects.collect(images != nullptr ? *images : section(reader, "mirror"),
                  [&] { read_mirrors(reader, scene); });
  scene.small = yes_or(reader.root, "small", false);
  const CaseNode &node = section(reader, "symmetric");
  defects.collect(node, [&] {
    if (node.value.empty()) return;
    const auto found = std::ranges::find(reader.parameters, node.value);
    const CaseNode *declared = section(reader, "parameters").find(node.value);
    scene.symmetric = declared != nullptr || is_yes(node);
    if (scene.symmetric && scene.dim == 3)
      throw bad_input("symmetric is of plane bodies: give a half of the solid with mirror");
    if (scene.symmetric && scene.axisymmetric)
      throw bad_input("an axisymmetric body is one half, without data beyond x = 0: leave out "
                      "symmetric");
    if (found != reader.parameters.end())
      scene.skewed_by = static_cast<int>(found - reader.parameters.begin());
  });
}

Expression share_of_domain(const Scene &scene, const Expression &value) {
  if (scene.mirrors.empty()) return value;
  return parse_expression("(" + value.text() + ") / " + std::to_string(image_count(scene.mirrors)));
}

void check_direction(const Scene &scene, const Point &direction, const std::string &what) {
  for (std::size_t c = 0; c < axes.size(); ++c)
    if (direction[c] != 0 && cancels(scene.mirrors, c))
      throw bad_input(what + " along " + axes[c] +
                      " cancels that of the mirror image: of the whole body there is none");
}

} // namespace rbvi
