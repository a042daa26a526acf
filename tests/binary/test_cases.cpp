// Case files from outside: check and new, geometries, what a run changes of a case.
#include "run.hpp"

namespace rbvi::cases_test {
namespace {

struct Cases : InDirectory {};

const std::string plate = "rbvi: 1\n"
                          "physics: plane_strain\n"
                          "mesh: {file: plate.geo, set: {hole: 0.3}}\n"
                          "parameters: {push: {range: [0, 0.02], default: 0.01}}\n"
                          "materials: {plate: {at: all, E: 1, nu: 0.3}}\n"
                          "imposed: {top: {at: top, ux: 0, uy: -push}}\n"
                          "contact: {floor: {at: floor, against: {plane: {normal: [0, -1], "
                          "position: 0}}}}\n"
                          "train: grid:3\n";

const std::string geometry =
    "DefineConstant[ hole = 0.2 ];\n"
    "SetFactory(\"OpenCASCADE\");\n"
    "Rectangle(1) = {0, 0, 0, 1, 1};\n"
    "Disk(2) = {0.5, 0.5, 0, hole};\n"
    "BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };\n"
    "Physical Surface(\"plate\") = {3};\n"
    "Physical Curve(\"top\") = {3};\n"
    "Physical Curve(\"floor\") = {1};\n"
    "Mesh.MeshSizeMax = 0.1;\n";

TEST_F(Cases, ANewOneIsRightAndIsNotWrittenTwice) {
  EXPECT_TRUE(contains(output_of(rbvi(1, "new block")), "wrote block/case.yaml"));
  const std::string says = output_of(rbvi(2, "check block -vtu u.vtu"));
  EXPECT_TRUE(contains(says, "no defect was found")) << says;
  EXPECT_TRUE(contains(says, "depth                [0.01, 0.1] m\n")) << says;
  EXPECT_TRUE(fs::exists("u.vtu"));
  expect_all_refused({{"new block", "is there already"},
                      {"new", "new takes the name of a folder"},
                      {"new a b", "'b' is left over"},
                      {"check", "no case is named"}});
  output_of(rbvi(2, "offline -case block -train grid:2,2,2 -out model"));
  EXPECT_TRUE(contains(output_of(rbvi_online("model/model.h5 --mu 0.05,0.1,0.3")), "normal_force"));
  output_of(rbvi(1, "verify -out model -valid random:2:1"));
}

TEST_F(Cases, ABodyThatNothingHoldsIsRefusedByEveryCommand) {
  output_of(rbvi(1, "new block"));
  std::string text = slurp("block/case.yaml");
  const std::string held = "ux: shear, uy: -depth";
  text.replace(text.find(held), held.size(), "uy: shear - depth");
  spill("block/case.yaml", text);
  const std::string says = "the body can move along (1, 0): impose displacements";
  expect_all_refused({{"check block", says},
                      {"solve -case block -mu 0.05,0,0.3", says},
                      {"offline -case block -out run", says}});
}

TEST_F(Cases, AMeshOfOnesOwnBeginsACaseOfIt) {
  spill("coarse.msh", coarse_gmsh());
  output_of(rbvi(1, "new own -mesh coarse.msh"));
  const std::string text = slurp("own/case.yaml");
  EXPECT_TRUE(contains(text, "mesh: {file: ../coarse.msh")) << text;
  EXPECT_TRUE(contains(text, "boundaries: boundary")) << text;
  EXPECT_EQ(shell(rbvi(1, "new other -mesh nowhere.msh")).status, 2);
  EXPECT_FALSE(fs::exists("other"));
}

TEST_F(Cases, DefectsAreToldAtOnce) {
  spill("wrong.yaml", plate + "loads: {a: {at: top, presure: 1}}\nfree: [push, pull]\n");
  const Finished run = shell(rbvi(2, "check wrong.yaml"));
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(lines_with(run.err, "rbvi: wrong.yaml:9:22: unknown key 'presure'"), 1) << run.err;
  spill("plate.yaml", plate);
  expect_all_refused({{"check plate.yaml", "the geometry plate.geo cannot be read"}});
}

/// Without the program gmsh a geometry is refused; its mesh stays in the run.
TEST_F(Cases, AGeometryIsMeshed) {
  spill("plate.yaml", plate);
  spill("plate.geo", geometry);
  if (std::system("command -v gmsh > /dev/null 2>&1") != 0) {
    expect_all_refused({{"check plate.yaml", "install Debian's package gmsh"}});
    GTEST_SKIP() << "there is no program gmsh";
  }
  output_of(rbvi(2, "offline -case plate.yaml -out model"));
  EXPECT_EQ(std::distance(fs::directory_iterator("model/mesh"), fs::directory_iterator{}), 1);
  fs::remove("plate.yaml");
  output_of(rbvi(1, "verify -out model -valid random:2:1"));
  spill("plate.yaml", plate);
  spill("plate.geo", "Rectangle(1 = 3;\n");
  expect_all_refused({{"check plate.yaml", "gmsh cannot mesh 'plate.geo'"}});
}

/// The command line, its paths, a variant, choices and the file.
TEST_F(Cases, WhatARunChangesOfACaseIsKept) {
  const std::string disk =
      "offline -case " RBVI_CASES "/rigid_disk -variant large -train grid:2,2,2 "
      "-set mesh.edges=24,let.initial_gap=0.002 -out model ";
  output_of(rbvi(2, disk));
  const std::string options = slurp("model/case.yaml");
  EXPECT_TRUE(contains(options, "case: scene.yaml\n") && contains(options, "variant: large\n"))
      << options;
  EXPECT_TRUE(contains(slurp("model/scene.yaml"), "physics: plane_strain"));
  const std::string again = output_of(rbvi(1, "offline -out model"));
  EXPECT_TRUE(contains(again, "8 of 8 samples") || contains(again, "reused") ||
              contains(again, "were there"))
      << again;
  const Finished other =
      shell(rbvi(1, "offline -out model -set mesh.edges=24,let.initial_gap=0.003"));
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(contains(other.err, "are of another scene")) << other.err;
}

} // namespace
} // namespace rbvi::cases_test
