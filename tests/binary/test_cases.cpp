// Case files from outside: check and new, geometries, what a run changes of a case.
#include "run.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

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
  // It warns of its few nodes.
  EXPECT_TRUE(contains(says, "no error was found; what was warned of stands")) << says;
  EXPECT_TRUE(contains(says, "depth                [0.01, 0.1] m\n")) << says;
  EXPECT_TRUE(contains(says, "\n  free                 sides: no condition, no load")) << says;
  EXPECT_TRUE(contains(says, "\n  a          exact, constant (2 terms)\n")) << says;
  EXPECT_TRUE(contains(says, "\nwrote u_mesh.vtu, u_surface.vtu, u_partners_middle.vtu, ")) << says;
  EXPECT_TRUE(fs::exists("u.vtu"));
  output_of(RBVI_FIGURES " u.vtu");
  EXPECT_TRUE(fs::exists("figures/case.png") && fs::exists("figures/solution.png"));
  expect_all_refused({{"new block", "is there already"},
                      {"new", "new takes the name of a folder"},
                      {"new a b", "'b' is left over"},
                      {"check", "no case is named"}});
  output_of(rbvi(2, "offline -case block -train 'corners + random:3:1' -out model"));
  EXPECT_TRUE(contains(output_of(rbvi_online("model/model.h5 --mu 0.05,0.1,0.3")), "normal_force"));
  const std::string trained = "warning: at 2 of 2 validation parameters the model was trained";
  EXPECT_TRUE(contains(output_of(rbvi(2, "verify -out model -valid random:2:1")), trained));
  EXPECT_TRUE(contains(output_of(rbvi(1, "bench -out model -valid random:2:1")), trained));
  EXPECT_FALSE(contains(output_of(rbvi(2, "verify -out model -valid random:2:2")), "trained"));
}

TEST_F(Cases, ABodyThatNothingHoldsIsRefusedByEveryCommand) {
  output_of(rbvi(1, "new block"));
  std::string text = slurp("block/case.yaml");
  const std::string held = "ux: shear, uy: -depth";
  text.replace(text.find(held), held.size(), "uy: shear - depth");
  const std::string friction = "coulomb: friction"; // which could hold it
  text.replace(text.find(friction), friction.size(), "coulomb: 0*friction");
  spill("block/case.yaml", text);
  const std::string says = "the body can move along (1, 0): impose displacements";
  expect_all_refused({{"check block", says},
                      {"solve -case block -mu 0.05,0,0.3", says},
                      {"offline -case block -out run", says}});
}

/// A block that its load presses onto the floor, or shears, or lifts.
TEST_F(Cases, WhereBodiesAreNotHeldIsTold) {
  const auto write = [](const std::string &press, const std::string &friction) {
    spill("pressed.yaml", "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 1}\n"
                          "parameters: {press: {range: " +
                              press + ", default: 1}, friction: {range: " + friction +
                              ", default: 0.5}}\n"
                              "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                              "loads: {top: {at: top, traction: [0, -press]}}\n"
                              "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], "
                              "position: 0}}, friction: {coulomb: friction}}}\n");
  };
  write("[0.5, 1]", "[0.2, 1]");
  EXPECT_FALSE(contains(output_of(rbvi(2, "check pressed.yaml")), "warning"));
  write("[0.5, 1]", "[0, 1]");
  const std::string says = output_of(rbvi(1, "check pressed.yaml"));
  EXPECT_TRUE(
      contains(says, "warning: no answer at press=0.5 friction=0: the body can move along (1, 0), "
                     "where no contact and no friction prevents it (the first of 3 such "
                     "parameters)\n"))
      << says;
  EXPECT_TRUE(contains(says, "no error was found; what was warned of stands")) << says;
  write("[-0.1, 1]", "[0.2, 1]");
  const std::string lifted = output_of(rbvi(2, "check pressed.yaml"));
  EXPECT_TRUE(contains(lifted, "warning: no answer at press=-0.1 friction=0.2: the body can move "
                               "along (0, 1), and is pushed where no contact and no friction can "
                               "hold it (the first of "))
      << lifted;
  EXPECT_TRUE(contains(lifted, "no error was found; what was warned of stands")) << lifted;
}

/// A body above a rim: triangles from (0, 1) to each edge.
std::string fan(const std::vector<std::array<double, 2>> &rim) {
  const std::size_t count = rim.size();
  std::ostringstream mesh;
  mesh.precision(17);
  mesh << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"top\"\n1 2 \"rim\"\n"
          "2 3 \"body\"\n$EndPhysicalNames\n$Nodes\n"
       << count + 1 << "\n1 0 1 0\n";
  for (std::size_t i = 0; i < count; ++i)
    mesh << i + 2 << ' ' << rim[i][0] << ' ' << rim[i][1] << " 0\n";
  mesh << "$EndNodes\n$Elements\n"
       << 2 * count << "\n1 1 2 1 1 1 2\n2 1 2 1 1 " << count + 1 << " 1\n";
  for (std::size_t i = 0; i + 1 < count; ++i)
    mesh << 2 * i + 3 << " 1 2 2 2 " << i + 2 << ' ' << i + 3 << "\n"
         << 2 * i + 4 << " 2 2 3 3 1 " << i + 2 << ' ' << i + 3 << "\n";
  return mesh.str() + "$EndElements\n";
}

TEST_F(Cases, AMeshOfOnesOwnBeginsACaseOfIt) {
  spill("coarse.msh", coarse_gmsh());
  expect_all_refused({{"new other -mesh nowhere.msh", "nowhere.msh"},
                      {"new other -mesh coarse.msh", "too few named boundaries (1)"}});
  EXPECT_FALSE(fs::exists("other"));
  std::string mesh = fan({{-1, 0.25}, {-0.5, 0}, {0, 0}, {0.5, 0}, {1, 0.25}});
  mesh.replace(mesh.find("\"rim\""), 5, "\"[it's: #1\"");
  spill("fan.msh", mesh);
  output_of(rbvi(1, "new own -mesh fan.msh"));
  const std::string text = slurp("own/case.yaml");
  EXPECT_TRUE(contains(text, "mesh: {file: '../fan.msh'")) << text;
  EXPECT_TRUE(contains(text, "boundaries: top, [it's: #1")) << text;
  EXPECT_TRUE(contains(output_of(rbvi(1, "check own")), "error was found")); // two edges: a warning
}

/// A body in the corner of a floor and a wall, which share the node there.
TEST_F(Cases, ACornerOfTwoContactsAsksForDegree2) {
  std::string mesh = fan({{-1, 0.5}, {-1, 0}, {0, 0}, {1, 0.2}});
  mesh.replace(mesh.find("3\n1 1 \"top\""), 1, "4\n1 4 \"wall\"");
  mesh.replace(mesh.find("\n3 1 2 2 2 2 3\n"), 15, "\n3 1 2 4 4 2 3\n");
  spill("corner.msh", mesh);
  for (const bool friction : {true, false})
    for (const char *degree : {"1", "2"}) {
      spill("corner.yaml",
            std::string("rbvi: 1\nphysics: plane_strain\nmesh: {file: corner.msh, degree: ") +
                degree +
                "}\nparameters: {push: {range: [0.01, 0.02], default: 0.01}}\n"
                "materials: {body: {at: all, E: 1, nu: 0.3}}\n"
                "imposed: {top: {at: top, ux: -push, uy: -push}}\ncontact:\n"
                "  floor: {at: rim, against: {plane: {normal: [0, -1], position: 0}}" +
                (friction ? ", friction: {coulomb: 0.3}" : "") +
                "}\n  wall: {at: wall, against: {plane: {normal: [-1, 0], position: 1}}}\n");
      const std::string says = output_of(rbvi(1, "check corner.yaml"));
      EXPECT_EQ(contains(says, "the contacts floor and wall share 1 node"),
                friction && degree == std::string("1"))
          << says;
    }
}

/// Half of a disk of radius 1, its edges 1 - cos(15 degrees) inside; and a wedge, which has a
/// corner.
TEST_F(Cases, RoundContactAlongStraightEdgesIsTold) {
  std::vector<std::array<double, 2>> round;
  for (int i = 0; i < 7; ++i)
    round.push_back({-std::cos(i * std::numbers::pi / 6), 1 - std::sin(i * std::numbers::pi / 6)});
  spill("body.msh", fan(round));
  const std::string body = "rbvi: 1\nphysics: plane_strain\nmesh: {file: body.msh}\n"
                           "parameters: {push: {range: [0, 0.02], default: 0.01}}\n"
                           "materials: {body: {at: all, E: 1, nu: 0.3}}\n"
                           "imposed: {top: {at: top, ux: 0, uy: -push}}\n"
                           "contact: {floor: {at: rim, against: {plane: {normal: [0, -1], "
                           "position: 0}}}}\n";
  spill("body.yaml", body);
  const std::string says = output_of(rbvi(2, "check body.yaml"));
  EXPECT_TRUE(contains(says,
                       "\n  rim                  turns smoothly: its straight edges are up to "
                       "3.4e-02 off an arc, and so are gaps"))
      << says;
  EXPECT_TRUE(contains(output_of(rbvi(1, "solve -case body.yaml -mu 0.01 -mesh_refine 1")),
                       "\nwarning: the contact boundary 'rim' turns smoothly"));
  spill("body.yaml", body + "curves: {rim: {circle: [0, 1, 1]}}\n");
  EXPECT_FALSE(contains(output_of(rbvi(2, "check body.yaml")), "turns smoothly"));
  spill("body.yaml", body);
  spill("body.msh", fan({{-1, 0.2}, {-0.5, 0.1}, {0, 0}, {0.5, 0.1}, {1, 0.2}}));
  EXPECT_FALSE(contains(output_of(rbvi(2, "check body.yaml")), "turns smoothly"));
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

/// With all that it includes as it is, and with the numbers that are set, or not at all.
TEST_F(Cases, AGeometryIsWhatItIncludesAndWhatIsSet) {
  if (std::system("command -v gmsh > /dev/null 2>&1") != 0) GTEST_SKIP() << "no program gmsh";
  const auto area = [&](const std::string &hole, const std::string &more = "") {
    spill("hole.inc", hole);
    return line_with(output_of(rbvi(1, "solve -case plate.yaml -mu 0.01 " + more)), "area ");
  };
  spill("plate.yaml", plate + "outputs: {area: {integral: 1, in: all}}\n");
  spill("plate.geo", "General.Verbosity = 1;\nInclude \"hole.inc\";\n" +
                         geometry.substr(geometry.find('\n') + 1));
  const std::string set = area("DefineConstant[ hole = 0.2 ];\n"),
                    again = area("DefineConstant[ hole = 0.1 ];\n"),
                    small = area("DefineConstant[ hole = 0.1 ];\n", "-set mesh.set="),
                    large = area("hole = 0.2;\n", "-set mesh.set=");
  EXPECT_EQ(again, set);
  EXPECT_NE(small, set);
  EXPECT_NE(large, small);
  expect_all_refused(
      {{"check plate.yaml", "mesh: set gives hole = 0.3, but 'plate.geo' makes it 0.2 by itself: "
                            "write DefineConstant[hole = ...]; there"},
       {"check plate.yaml -set mesh.set.hole=,mesh.set.whole=0.3",
        "mesh: set gives whole, a number that 'plate.geo' does not have"}});
}

/// A plane as a level set is the same plane: friction, and which nodes stick, included.
TEST_F(Cases, PlanesAsLevelSetsGiveTheAnswersOfPlanes) {
  if (std::system("command -v gmsh > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "there is no program gmsh";
  const std::string seal =
      "solve -case " RBVI_CASES "/seal -mu 0.6,0.2,0.3,0.45 -set 'mesh.set.edges=40";
  std::string levels = seal;
  for (const auto &[contact, level] :
       {std::pair{"bottom", "y"}, {"wall", "x"}, {"lid", "5.33 - squeeze - y"}})
    levels += std::string(",contact.") + contact + ".against.plane=,contact." + contact +
              ".against.level_set=" + level;
  const std::string planes = output_of(rbvi(1, seal + "'"));
  levels = output_of(rbvi(1, levels + "'"));
  for (const std::string name : {"energy", "normal_force", "tangential_force", "contact_nodes",
                                 "stick_nodes", "peak_pressure"})
    EXPECT_NEAR(value_of(levels, name), value_of(planes, name),
                1e-7 * std::abs(value_of(planes, name)))
        << name;
}

/// Those of the case, at parameters that are free and that are not.
TEST_F(Cases, TestsAreProved) {
  const std::string one = "check " RBVI_CASES "/patch -bodies one ";
  const std::string says = output_of(rbvi(2, one + "-run"));
  EXPECT_EQ(lines_with(says, "  sticking "), 2) << says;
  EXPECT_EQ(lines_with(says, "  slipping "), 2) << says;
  EXPECT_TRUE(contains(says, "passed") && !contains(says, "FAILED")) << says;
  EXPECT_FALSE(contains(output_of(rbvi(1, one)), "sticking"));
  const Finished wrong =
      shell(rbvi(2, "check " RBVI_CASES "/patch -run -set tests.strain.expect.energy=0.031"));
  EXPECT_EQ(wrong.status, 1);
  EXPECT_TRUE(contains(wrong.err, "rbvi: 1 of 1 test of the case failed: 'strain'")) << wrong.err;
  EXPECT_TRUE(contains(wrong.out, "energy                0.03009259259 expected          0.031, "
                                  "off by 2.9e-02 of 1.0e-09: FAILED"))
      << wrong.out;
  expect_all_refused({{"check " RBVI_CASES "/patch -run -set tests=", "this case has no 'tests:'"},
                      {"solve -case " RBVI_CASES "/patch -mu 0.05 -run", "-run has no effect"}});
}

/// In what is printed, in files and in what they hold.
TEST_F(Cases, ContactsHaveTheirNames) {
  const std::string says = output_of(
      rbvi(2, "solve -case " RBVI_CASES "/roller -set mesh.edges=24 -mu 0.04,0.1 -vtu u.vtu"));
  EXPECT_EQ(lines_with(says, "upper plate: normal_force "), 1) << says;
  EXPECT_EQ(lines_with(says, "lower plate: normal_force "), 1) << says;
  EXPECT_TRUE(contains(says, "wrote u.vtu, u_contact_upper_plate.vtu, u_contact_lower_plate.vtu"))
      << says;
  expect_fields("u_contact_lower_plate.vtu", {"contacts", "pressure", "tangential_stress"});
}

/// The mesh of a case is what its facts say, or is refused; numbers of a run may have units.
TEST_F(Cases, FactsOfItsMeshAndUnits) {
  spill("coarse.msh", coarse_gmsh());
  const std::string membrane =
      "rbvi: 1\n"
      "physics: membrane\n"
      "units: {length: m, force: N}\n"
      "mesh: {file: coarse.msh, facts: {all: {box: [-0.5, -0.5, 0.5, 0.5]}, "
      "boundary: {size: 4}}}\n"
      "parameters: {height: {range: [-0.2 m, -0.1 m], default: -150 mm, "
      "unit: m}}\n"
      "imposed: {rim: {at: boundary, u: 0}}\n"
      "loads: {weight: {at: all, force: -25}}\n"
      "contact: {table: {at: obstacle, above: height}}\n";
  spill("case.yaml", membrane);
  const std::string says = output_of(rbvi(1, "check case.yaml -height '-160 mm,-14 cm'"));
  EXPECT_TRUE(contains(says, "  the mesh             is the box [-0.5, 0.5] x [-0.5, 0.5]\n"))
      << says;
  EXPECT_TRUE(contains(says, "  boundary             is of length 4\n")) << says;
  EXPECT_TRUE(contains(says, "at the middle of the box, height=-0.15:\n")) << says;
  EXPECT_TRUE(contains(output_of(rbvi(1, "-help -case case.yaml")), "boundary   of length 4\n"));
  expect_all_refused(
      {{"check case.yaml -set mesh.facts.boundary.size=3",
        "'boundary' of mesh file 'coarse.msh' is "
        "not of length 3: its length is 4"},
       {"check case.yaml -height '2 MPa'", "option -height: a length is wanted, 2 MPa is a stress"},
       {"solve -case case.yaml -mu '-150 mm'", "'-150 mm': not a number; give it in m"}});
}

/// Numbers without a unit are in that of the parameter, to rbvi and to rbvi-online. Parameters may
/// be called mu, by which coefficients of friction go, but not like other options.
TEST_F(Cases, ParametersHaveUnitsAndMayBeCalledMu) {
  spill("case.yaml",
        "rbvi: 1\nphysics: plane_strain\nunits: {length: mm, force: N}\n"
        "mesh: {built_in: one_block, degree: 1}\n"
        "parameters:\n  depth: {range: [10, 100], default: 50, unit: um}\n"
        "  mu: {range: [0.1, 0.5], default: 0.3}\n  young: {default: 10 MPa}\n"
        "materials: {b: {at: all, E: young, nu: 0}}\nimposed: {top: {at: top, ux: 0, uy: -depth}}\n"
        "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
        "friction: {coulomb: mu}}}\noutputs: {share: {value: mu, point: [0.5, 0.25]}}\n"
        "train: grid:3,2\n");
  EXPECT_TRUE(
      contains(output_of(rbvi(1, "check case.yaml")), "  depth                [10, 100] um\n"));
  const auto value_of = [](const std::string &text, const std::string &name) {
    const std::size_t at = text.find("\n" + name + " ");
    return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + name.size() + 2));
  };
  const std::string solve = output_of(rbvi(1, "solve -case case.yaml -mu mu=0.4,depth=60"));
  EXPECT_NEAR(value_of(solve, "normal_force"), 10 * 0.06 / 0.5, 1e-9);
  EXPECT_NEAR(value_of(solve, "share"), 0.4, 1e-12);
  const std::string kilo =
      "solve -case case.yaml -mu 60,0.4 -young '20000 kPa' -depth '0.01 mm,90'";
  EXPECT_NEAR(value_of(output_of(rbvi(1, kilo)), "normal_force"), 2.4, 1e-9);
  output_of(rbvi(1, "offline -case case.yaml -out model"));
  const std::string query = output_of(rbvi_online("model/model.h5 --mu depth=60,mu=0.4"));
  EXPECT_NEAR(value_of(query, "normal_force"), 1.2, 1e-8);
  EXPECT_NEAR(value_of(query, "share"), 0.4, 1e-8);
  std::string other = slurp("case.yaml");
  for (std::size_t at = 0; (at = other.find("mu", at)) != std::string::npos; at += 3)
    other.replace(at, 2, "out");
  spill("out.yaml", other);
  expect_all_refused({{"check out.yaml", "out.yaml:7:3: -out is an option of the program"}});
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
