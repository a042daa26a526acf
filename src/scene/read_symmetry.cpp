#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr std::array<const char *, 2> axes{"x", "y"};

/// mirror_images: N is short for planes through the origin.
MirrorPlanes mirrors_in(const Reader &reader) {
  const CaseNode &planes = section(reader, "mirror");
  const double images = number_or(reader, reader.root, "mirror_images", 1);
  if (images != 1 && images != 2 && images != 4)
    throw bad_input("mirror_images is " + short_number(images) +
                    ": 2 is a body that goes on beyond x = 0, 4 one that goes on beyond y = 0, "
                    "too; mirror: {x: ..., y: ...} names other planes");
  if (images > 1 && !planes.entries.empty())
    throw bad_input("mirror_images and mirror say the same: leave out mirror_images");
  if (images == 2) return {{0, 0}};
  if (images == 4) return {{0, 0}, {1, 0}};
  MirrorPlanes mirrors;
  for (int c = 0; c < 2; ++c)
    if (const CaseNode *position = planes.find(axes[c]))
      mirrors.push_back({c, number_in(reader, *position)});
  return mirrors;
}

void read_mirrors(const Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode *planes = reader.root.find("mirror"), *images = reader.root.find("mirror_images");
  if (planes == nullptr && images == nullptr) return;
  defects.collect(images != nullptr ? *images : *planes, [&] {
    scene.mirrors = mirrors_in(reader);
    if (scene.axisymmetric && cancels(scene.mirrors, 0))
      throw bad_input("an axisymmetric body is whole about its axis x = 0: leave out this plane "
                      "of symmetry");
  });
}

} // namespace

void read_symmetry(const Reader &reader, Scene &scene, Defects &defects) {
  read_mirrors(reader, scene, defects);
  scene.small = yes_or(reader.root, "small", false);
  const CaseNode &node = section(reader, "symmetric");
  defects.collect(node, [&] {
    if (node.value.empty()) return;
    const auto found = std::ranges::find(reader.parameters, node.value);
    const CaseNode *declared = section(reader, "parameters").find(node.value);
    scene.symmetric = declared != nullptr || is_yes(node);
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
