#include "rbvi/scene/case.hpp"

#include "rbvi/core/text.hpp"

namespace rbvi {

std::string new_case() {
  return R"(# A block that is pushed onto a floor with friction and sheared. All keys: cases/CASE_FILE.md.
rbvi: 1
says: block on a floor with friction
physics: plane_strain
mesh: {built_in: one_block, degree: 2} # or {file: MESH.msh}; 1 wide, 0.5 high

parameters: # what has a range can vary; what has none is a constant that a run may change
  depth:    {range: [0.01, 0.1], default: 0.05, unit: m, says: how far the top is pushed down}
  shear:    {range: [0, 0.2], default: 0.05, unit: m, says: how far the top is moved sideways}
  friction: {range: [0.1, 1], default: 0.3, says: coefficient of friction}
  young:    {default: 15, unit: Pa, says: Young's modulus}

materials:
  rubber: {at: all, E: young, nu: 0.35}
imposed: # a component that is absent is free
  top: {at: top, ux: shear, uy: -depth}
contact:
  floor:
    at: contact
    against: {plane: {normal: [0, -1], position: 0}} # out of the body; along it from [0, 0]
    friction: {coulomb: friction}

train: grid:4,4,4
validate: random:20:2
)";
}

std::string new_case(const std::string &physics, const std::string &mesh, const std::string &parts,
                     const std::string &imposed, const std::string &contact, double depth) {
  const std::string range = "[" + short_number(depth / 10) + ", " + short_number(depth) + "]";
  return "# All keys: cases/CASE_FILE.md. " + parts + R"(
rbvi: 1
physics: )" +
         physics + R"(
mesh: {file: )" +
         mesh + R"(, degree: 2}

parameters: # what has a range can vary; what has none is a constant that a run may change
  depth: {range: )" +
         range + ", default: " + short_number(depth / 2) +
         R"(, says: how far the body is pushed down}
  young: {default: 1, says: Young's modulus}

materials:
  body: {at: all, E: young, nu: 0.3}
imposed: # a component that is absent is free
)" + imposed +
         R"(contact: # a normal points out of the body; the plane lies at x . normal = position
)" + contact +
         R"(
train: grid:5
validate: random:20:2
)";
}

} // namespace rbvi
