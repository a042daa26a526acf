// Wrong case files: each is refused where it is wrong, with what to do.
#include "wrong_case.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <random>

namespace rbvi::wrong_cases_test {
namespace {

TEST(WrongCase, Outputs) {
  const auto outputs = [](const std::string &text) { return Sections{{"outputs", text}}; };
  EXPECT_EQ(said(block_case(outputs("{force: {integral: pressure, where: x > depth}}"))), "");
  expect_refused({
      {outputs("{force: {sum: gap}}"), "unknown key 'sum'"},
      {outputs("{force: {max: gab}}"), "unknown name 'gab' in 'gab': the nearest is 'gap'"},
      {outputs("{force: {max: gap, mean: gap}}"), "it has mean and max"},
      {outputs("{force: {at: floor}}"), "an output is one of integral"},
      {outputs("{force: {max: gap, at: flor}}"),
       "the built-in mesh one_block has no boundary 'flor'"},
      {outputs("{force: {max: gap, at: top}}"),
       "there is no 'gap' at 'top': pressure, gap, tangential, slip, contact and stick are over "
       "contacts (floor)"},
      {outputs("{force: {max: nx, at: floor}}"), "there is no 'nx' at 'floor'"},
      {outputs("{force: {max: nx, in: all}}"), "there is no 'nx' there"},
      {outputs("{force: {max: u, in: all}}"), "u is that of a membrane"},
      {outputs("{force: {max: uy, at: [floor, top]}}"), "has no boundary 'floor'"},
      {outputs("{force: {max: uy, at: floor, in: all}}"), "an output has one place"},
      {outputs("{force: {value: uy, in: all}}"), "a value is that at a point"},
      {outputs("{force: {max: uy, point: [0, 0]}}"), "a value is that at a point"},
      {outputs("{force: {reaction: [0, 2], at: top}}"), "the direction of a reaction has the"},
      {outputs("{force: {reaction: [0, 1]}}"), "a reaction is that of boundaries, whole"},
      {outputs("{force: {reaction: [0, 1], at: top, where: x > 0}}"), "of boundaries, whole"},
      {outputs("{force: {spring: bolt}}"), "there is no spring 'bolt'"},
      {outputs("{force: {spring: bolt, at: top}}"), "that of the whole spring"},
      {outputs("{energy: {max: gap}}"), "tables have a column 'energy' already"},
      {outputs("{depth: {max: gap}}"), "tables have a column 'depth' already"},
      {outputs("{part: {measure: gap > 0, where: x > 0}}"), "write 'A and B' in place of 'where'"},
      {{{"let", "{gap: depth}"}, {"outputs", "{open: {max: gap}}"}},
       "in outputs 'gap' is the field of that name"},
  });
}

/// At its line, not by the first solve: what a membrane has not.
TEST(WrongCase, OutputsOverTheContactOfAMembrane) {
  const auto with = [](const std::string &output) {
    return said("rbvi: 1\nphysics: membrane\nmesh: {built_in: square_with_disc}\n"
                "parameters: {height: {range: [-1, 1], default: 0}}\n"
                "imposed: {rim: {at: boundary, u: 0}}\n"
                "contact: {c: {at: obstacle, above: height}}\noutputs:\n  own: " +
                output + "\n");
  };
  for (const char *over :
       {"{measure: stick, at: c}", "{integral: tangential}", "{max: slip}", "{max: ux, at: c}"}) {
    const std::string message = with(over);
    EXPECT_TRUE(message.starts_with("x.yaml:8:")) << message;
    EXPECT_NE(message.find("has no tangential, slip and stick"), std::string::npos) << message;
  }
  for (const char *over : {"{max: u, in: obstacle}", "{measure: contact, at: c}",
                           "{integral: pressure*x, where: y > 0}", "{max: u - gap}"})
    EXPECT_EQ(with(over), "") << over;
}

TEST(WrongCase, TheBlockItselfIsRight) {
  EXPECT_EQ(said(block_case()), "");
}

TEST(WrongCase, Keys) {
  expect_refused({
      {{{"rbvi", ""}}, "'rbvi' is missing"},
      {{{"physics", ""}}, "'physics' is missing"},
      {{{"mesh", ""}}, "'mesh' is missing"},
      {{{"parameters", ""}}, "'parameters' is missing"},
      {{{"contact", ""}}, "'contact' is missing"},
      {{{"materials", ""}}, "an elastic body needs 'materials:'"},
      {{{"material", "{}"}}, "unknown key 'material': the nearest is 'materials'"},
      {{{"springs", "{bolts: {stiffness: 1}}"}}, "'at' a boundary, or 'between: [one, other]'"},
      {{{"springs", "{bolts: {at: top}}"}}, "a stiffness, or a pretension, or both"},
      {{{"springs", "{bolts: {at: top, stiffness: k*x}}"}}, "does not depend on the place"},
      {{{"springs", "{bolts: {between: [top], stiffness: k}}"}}, "between two boundaries"},
      {{{"springs", "{bolts: {at: top, stiffness: k, direction: [1, 1]}}"}}, "of length 1"},
      {{{"springs", "{bolts: {at: top, stiffness: k, settled: 1}}"}}, "give both"},
      {{{"rbvi", "2"}}, "rbvi is '2': this build reads version 1"},
      {{{"physics", "plane_stran"}}, "physics is 'plane_stran': use one of"},
      {{{"physics", "axisymmetric"}, {"symmetric", "yes"}}, "leave out symmetric"},
      {{{"physics", "axisymmetric"},
        {"contact",
         "{f: {at: contact, lumped: yes, against: {plane: {normal: [0, -1], position: 0}}}}"}},
       "leave out lumped"},
      {{{"physics", "[plane_strain]"}}, "physics is a list"},
      {{{"parameters", "depth"}}, "parameters is a table"},
      {{{"parameters", "[depth]"}}, "parameters is a table"},
      {{{"parameters", "{depth: 0.05}"}}, "depth is a table"},
      {{{"mesh", "one_block"}}, "mesh is a table"},
      {{{"mesh", "{built_in: one_block, egdes: 4}"}},
       "unknown key 'egdes' of mesh: the nearest is"},
      {{{"contact", "{floor: {at: contact, agaisnt: top}}"}}, "the nearest is 'against'"},
      {{{"contact", "{floor: {against: {plane: {normal: [0, -1], position: 0}}}}"}},
       "'at' is missing"},
      {{{"imposed", "{top: {at: top, uz: 0}}"}}, "uz and force_z are of a solid"},
      {{{"materials", "{rubber: {at: all, E: 15}}"}}, "'nu' is missing"},
      {{{"materials", "{rubber: {at: all, lambda: 15}}"}}, "'mu' is missing"},
      {{{"materials", "{rubber: {at: all, lambda: 15, mu: 5, E: 3}}"}},
       "E and nu, or lambda and mu"},
      {{{"materials", "{rubber: {at: all, E: 15, nu: nu, expansion: 1}}"}}, "belong together"},
      {{{"materials", "{rubber: {at: all, E: 15, nu: nu, expansion: 1, temperature: 1}}"},
        {"contact", "{f: {at: contact, formulation: nitsche, against: {plane: {normal: [0, -1], "
                    "position: 0}}}}"}},
       "has no stress of a temperature"},
      {{{"free", "{depth: 1}"}}, "free is no table"},
  });
}

TEST(WrongCase, BodiesAndContact) {
  const auto floor = [](const std::string &text) {
    return Sections{{"contact", "{floor: {at: contact, " + text + "}}"}};
  };
  const std::string plane = "against: {plane: {normal: [0, -1], position: 0}}";
  const std::string disk = "against: {disk: {center: [0.5, -1], radius: 1}}";
  expect_refused({
      {{{"mesh", "{built_in: one_blokc}"}}, "there is no built-in mesh 'one_blokc'"},
      {{{"mesh", "{}"}}, "built_in"},
      {{{"mesh", "{built_in: one_block, file: a.msh}"}}, "'built_in: SHAPE' or 'file: FILE.msh'"},
      {{{"mesh", "{built_in: one_block, degree: 3}"}}, "degree is '3': use one of 1, 2"},
      {{{"mesh", "{built_in: one_block, edges: 4}"}}, "edges of one_block is fixed"},
      {{{"materials", "{rubber: {at: wall, E: 15, nu: 0.3}}"}}, "no region 'wall'"},
      {{{"materials", "{a: {at: all, E: 15, nu: 0.3}, b: {at: all, E: 1, nu: 0.3}}"}},
       "a material of all cells leaves none for another"},
      {{{"mesh", "{file: a.msh}"},
        {"materials", "{a: {at: [l, r], E: 15, nu: 0.3}, b: {at: r, E: 1, nu: 0.3}}"}},
       "the region 'r' has a material already"},
      {{{"imposed", "{top: {at: tpo, ux: 0}}"}}, "no boundary 'tpo': it has sides, top, contact"},
      {{{"imposed", "{top: {at: top}}"}}, "neither ux nor uy"},
      {{{"imposed", "{top: {at: top, u: 0}}"}}, "components ux and uy"},
      {{{"imposed", "{a: {at: top, ux: 0}, b: {at: top, ux: 1}}"}}, "imposed twice on 'top'"},
      {{{"loads", "{a: {at: all, pressure: 1}}"}}, "act on boundaries"},
      {{{"loads", "{a: {at: sides, pressure: 1, traction: [1, 0]}}"}}, "a load is a force"},
      {{{"loads", "{a: {at: sides, traction: [1]}}"}}, "a load of 1 component"},
      {{{"loads", "{a: {at: sides}}"}}, "a load is a force"},
      {floor("above: 0"), "no region 'contact'"},
      {{{"contact",
         "{floor: {at: [contact, top], against: {plane: {normal: [0, -1], position: 0}}}}"}},
       "contact is at one boundary"},
      {floor("lumped: yes"), "contact is 'above: HEIGHT' or 'below: HEIGHT' of a membrane"},
      {floor("against: {}"), "against: a boundary"},
      {floor("against: {wall: {}}"), "unknown key 'wall'"},
      {floor("against: {plane: {normal: [0, -2], position: 0}}"), "give one of length 1"},
      {floor("against: {plane: {normal: [0, -1]}}"), "'position' is missing"},
      {floor(plane + ", multiplier: p1"), "with something rigid has no 'multiplier'"},
      {floor(plane + ", normal: deformed, kinematics: large"), "needs a boundary on a circle"},
      {floor(plane + ", lumped: maybe"), "use yes or no"},
      {floor(plane + ", friction: 0.3"), "friction is a table"},
      {floor(plane + ", friction: {coulomb: 0.3, tresca: 1}"), "'coulomb: COEFFICIENT' or"},
      {floor(plane + ", friction: {tresca: 1, limit: 2}"), "beside 'coulomb' alone"},
      {floor(plane + ", formulation: penalty"), "use one of mixed, nitsche"},
      {floor(plane + ", formulation: nitsche, lumped: yes"), "is for contact by multipliers"},
      {floor(plane + ", adhesion: 1, formulation: nitsche"), "not for formulation: nitsche"},
      {floor(plane + ", adhesion: 1, kinematics: large"), "not for kinematics: large"},
      {floor(plane + ", adhesion: 1, lumped: yes"), "not for lumped: yes"},
      {floor("against: top, adhesion: 1"), "between bodies has no 'adhesion'"},
      {floor(plane + ", formulation: nitsche, nitsche_gamma0: 0"), "between 0.1 and 2000"},
      {floor(disk + ", normal: body"), "needs a boundary on a circle"},
      {floor(disk + ", kinematics: large, gap: ray"), "leave out gap"},
      {floor(disk + ", normal: deformed"), "use it with kinematics: large"},
      {floor("against: {disk: {center: [0.5], radius: 1}}"), "center of a disk is [x, y]"},
      {floor("against: top, formulation: nitsche"), "between bodies has no 'formulation'"},
      {floor("against: top, kinematics: large, friction: {coulomb: 0.3}"), "small alone"},
      {floor("against: top, kinematics: large, projection: vertical"), "for small deformations"},
      {floor("against: tpo"), "no boundary 'tpo'"},
      {floor("against: top, kinematics: large, integration: direct"), "for small deformations"},
      {{{"curves", "{contact: {circle: [0, 0, -1]}}"}}, "the radius of a circle is positive"},
      {{{"curves", "{contact: {circle: [0, 0]}}"}}, "a list of 3 numbers"},
      {{{"symmetric", "perhaps"}}, "use yes or no"},
      {{{"choices", "{a: {b: {}}}"}}, "needs a default"},
      {{{"choices", "{a: {default: c, b: {}}}"}}, "use one of b"},
      {{{"choices", "{a: {default: b, b: {contact.wall.lumped: yes}}}"}}, "'contact.wall'"},
      {{{"options", "{pod: {tolerance: 1}}"}}, "options are not nested"},
  });
}

TEST(WrongCase, Tests) {
  const auto test = [](const std::string &at, const std::string &more) {
    return Sections{{"tests", "{known: {at: {" + at + "}, " + more + "}}"}};
  };
  const std::string rest = "expect: {energy: 1}, tolerance: 1e-3";
  const auto expects = [&](const std::string &what) {
    return test("depth: 0.05", "tolerance: 1e-3, expect: " + what);
  };
  EXPECT_EQ(said(block_case(test("depth: 0.05, k: 2", rest))), "");
  expect_refused({
      {test("dept: 0.05", rest), "there is no parameter 'dept': the nearest is 'depth'"},
      {test("young: 15", rest), "young is a constant"},
      {test("depth: deep", rest), "'deep' has the name deep"},
      {test("depth: 0.2", rest), "depth is 0.2: its range of validity is [0.01, 0.1]"},
      {test("nu: 0.5", rest), "nu is 0.5: its range of validity is"},
      {test("depth: [0.05]", rest), "depth is a list"},
      {test("depth: 0.05 mm", rest), "no units are declared"},
      {expects("{enrgy: 1}"), "there is no output 'enrgy': the nearest is 'energy'"},
      {expects("{energy: 1/0}"), "is not finite"},
      {expects("{energy: {is: 1}}"), "energy is no table"},
      {expects("{}"), "a test expects an output"},
      {expects("energy"), "expect is a table"},
      {test("depth: 0.05", "tolerance: 1"), "'expect' is missing"},
      {test("depth: 0.05", "expect: {energy: 1}"), "'tolerance' is missing"},
      {test("depth: 0.05", "expect: {energy: 1}, tolerance: 0"), "is positive"},
      {test("depth: 0.05", rest + ", mesh: {}"), "unknown key 'mesh' of tests: the nearest is"},
      {{{"tests", "{known: 1}"}}, "known is a table"},
      {{{"units", "{length: mm, force: N}"},
        {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05, unit: mm}}"},
        {"materials", "{rubber: {at: all, E: 15, nu: 0.3}}"},
        {"tests", "{known: {at: {depth: 2 N}, " + rest + "}}"}},
       "a length"},
  });
}

TEST(WrongCase, FactsOfAMesh) {
  const auto facts = [](const std::string &text) {
    return Sections{{"mesh", "{file: a.msh, facts: {" + text + "}}"},
                    {"materials", "{rubber: {at: core, E: young*k, nu: nu}}"}};
  };
  expect_refused({
      {{{"mesh", "{built_in: one_block, facts: {all: {size: 1}}}"}}, "have their own"},
      {facts("tpo: {size: 1}"), "no section of the case names a part 'tpo' of the mesh: the "
                                "nearest is 'top'"},
      {facts("top: {}"), "give box, disk, segment, arc, size or within"},
      {facts("top: {line: [0, 0, 1, 0]}"), "unknown key 'line' of mesh: facts"},
      {facts("top: {segment: [0, 0, 1]}"), "a list of 4 numbers"},
      {facts("top: {segment: [0, 0, 0, 0]}"), "the same point"},
      {facts("top: {box: [0, 0, 0, 1]}"), "the lower corner comes first"},
      {facts("core: {disk: [0, 0, 0]}"), "the radius of a disk is positive"},
      {facts("top: {arc: [0, 0, -1, 0, pi]}"), "the radius of an arc is positive"},
      {facts("top: {arc: [0, 0, 1, 0, 180]}"), "angles in radians"},
      {facts("top: {arc: [0, 0, 1, pi, 0]}"), "counterclockwise"},
      {facts("top: {box: [0, 0, 1, 1], segment: [0, 1, 1, 1]}"), "a part has one place"},
      {facts("core: {segment: [0, 1, 1, 1]}"), "segment is a place of boundaries"},
      {facts("core: {within: top}"), "within is of boundaries"},
      {facts("top: {size: 0}"), "the size of a part is positive"},
      {facts("top: {size: k}"), "has the name k"},
      {{{"units", "{length: mm, force: N}"},
        {"mesh", "{file: a.msh, facts: {top: {box: [0, 0, 1 "
                 "MPa, 1]}}}"}},
       "a length is wanted"},
  });
}

TEST(WrongCase, AllDefectsAreToldAtOnceByTheirPlaces) {
  const std::string message = said("rbvi: 1\n"
                                   "physics: plane_strain\n"
                                   "mesh: {built_in: one_block}\n"
                                   "parameters:\n"
                                   "  depth: {range: [0.1, 0.01], default: 0.05}\n"
                                   "materials:\n"
                                   "  rubber: {at: all, E: yonug, nu: 0.3, rho: 1}\n"
                                   "imposed:\n"
                                   "  top: {at: top, ux: 0, uy: -detph}\n"
                                   "contact:\n"
                                   "  floor: {at: contact}\n"
                                   "loads: 3\n");
  const std::vector<std::string> starts{
      "x.yaml:5:3: ", "x.yaml:7:21: ", "x.yaml:7:40: ", "x.yaml:9:25: ", "x.yaml:12:1: "};
  std::size_t from = 0;
  for (const std::string &start : starts) {
    const std::size_t at = message.find(start, from);
    EXPECT_NE(at, std::string::npos) << start << "\n" << message;
    from = std::min(at, message.size());
  }
  EXPECT_EQ(std::ranges::count(message, '\n'), 4) << message;
}

/// Texts that are damaged at random are right or refused; RBVI_FUZZ_SECONDS=3600 goes on for an
/// hour.
TEST(WrongCase, DamagedTextsAreRefusedOrRead) {
  const std::string whole = block_case({{"let", "{a: 2}"},
                                        {"loads", "{own: {at: all, force: [0, -a*k]}}"},
                                        {"choices", "{c: {default: d, d: {}, e: {let.a: 3}}}"},
                                        {"tests", "{t: {at: {depth: 0.05}, expect: {energy: 1}, "
                                                  "tolerance: 1e-3}}"}});
  const std::string pieces = "{}[]:,'\" \n\t-#&*?|>%@!0e.(^)\xc3\x01~";
  std::mt19937 random(5);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const char *asked = std::getenv("RBVI_FUZZ_SECONDS");
  const std::time_t end = std::time(nullptr) + (asked == nullptr ? 0 : std::atol(asked));
  for (int i = 0; i < 3000 || std::time(nullptr) < end; ++i) {
    std::string text = whole;
    for (std::size_t k = 1 + below(4); k > 0; --k) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
      case 0:
        text.erase(at, 1 + below(6));
        break;
      case 1:
        text.insert(at, 1, pieces[below(pieces.size())]);
        break;
      case 2:
        text[at] = pieces[below(pieces.size())];
        break;
      default:
        text.insert(at, text.substr(below(text.size()), below(30)));
        break;
      }
    }
    (void)said(text);
  }
}

} // namespace
} // namespace rbvi::wrong_cases_test
