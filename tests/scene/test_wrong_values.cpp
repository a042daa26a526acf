// Wrong expressions, parameters, units and names in case files.
#include "wrong_case.hpp"

namespace rbvi::wrong_cases_test {
namespace {

TEST(WrongCase, Expressions) {
  const auto young = [](const std::string &text) {
    return Sections{{"materials", "{rubber: {at: all, E: '" + text + "', nu: nu}}"}};
  };
  expect_refused({
      {young("young *"), "column 8"},
      {young("yuong*k"), "unknown name 'yuong' in 'yuong*k': the nearest is 'young'"},
      {young("young**k"), "write ^"},
      {young("young*foo(k)"), "foo"},
      {young("sin()"), "column"},
      {young("(young"), "column"},
      {young("young k"), "column"},
      {young("15 GPa"), "units"},
      {young(""), "belongs here"},
      {{{"let", "{x: 2}"}}, "'x' is the name of a coordinate"},
      {{{"let", "{k: 2}"}}, "there is a parameter 'k' already"},
      {{{"let", "{a: b, b: 2}"}}, "unknown name 'b'"},
      {{{"map", "[x]"}}, "the map has two components"},
      {{{"map", "[atan2(x, 1), y]"}}, "column"}, // the comma inside of the list
      {{{"map", "{scael: 2}"}}, "unknown key 'scael' of map"},
      {{{"imposed", "{top: {at: top, uy: -depth + nx}}"}}, "unknown name 'nx'"},
      {{{"motion", "[0]"}}, "the motion has 2 components"},
      {{{"imposed", "{top: {at: top, uy: motion}}"}}, "there is no 'motion:'"},
      {{{"units", "{length: mm, force: N}"},
        {"materials", "{rubber: {at: all, E: 15 mm, nu: nu}}"}},
       "a length"},
      {{{"units", "{length: parsec, force: N}"}}, "parsec"},
      {{{"require", "{r: {that: depth < x, says: no}}"}}, "unknown name 'x'"},
      {{{"require", "{r: {that: depth < 1, says: 'a {depth'}}"}}, "is not closed"},
  });
}

TEST(WrongCase, Parameters) {
  const auto k = [](const std::string &text) {
    return Sections{{"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}, k: {" + text +
                                       "}, nu: {default: 0.3}, young: {default: 15}}"}};
  };
  expect_refused({
      {k("range: [2, 1], default: 1"), "the lower bound comes first"},
      {k("range: [1, 1], default: 1"), "the lower bound comes first"},
      {k("range: [1, 2], default: 3"), "lies outside of its range"},
      {k("range: [1, 2]"), "'default' is missing"},
      {k("range: 1, default: 1"), "a list of 2 numbers"},
      {k("range: [1, 2, 3], default: 1"), "a list of 2 numbers"},
      {k("range: [a, 2], default: 1"), "has the name a"},
      {k("range: [1, 2], default: one"), "has the name one"},
      {k("range: [1, 2], default: 1/0"), "is not finite"},
      {k("range: [1, 2], default: 1.5, limits: [1.6, 3]"), "outside of [1.6, 3]"},
      {k("values: [one, two], default: three"), "one of one, two"},
      {k("values: [one, two], default: 2"), "the default of k is one of one, two"},
      {k("values: [one, two], default: one, range: [0, 1]"), "k has values: it has no 'range'"},
      {k("values: [one], default: one"), "names, two at least"},
      {k("values: [1, 2], default: 1"), "names, two at least"},
      {k("values: [pi, old], default: old"), "names, two at least"},
      {k("values: [x, old], default: old"), "names, two at least"},
      {k("values: [young, old], default: old"), "there is a parameter 'young' already"},
      {k("range: [1, 2], default: 1.5, spacing: cubic"), "use one of linear, log"},
      {k("range: [-1, 2], default: 1, spacing: log"), "is not positive"},
      {{{"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}, k: {default: 1}, "
                       "nu: {range: [0.1, 0.6], default: 0.55}, young: {default: 15}}"}},
       "parameter nu is 0.55, outside of [-0.99, 0.4999]"},
      {{{"materials", "{rubber: {at: all, E: k, nu: nu}}"},
        {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}, nu: {default: 0.3}, "
                       "k: {default: -1}}"}},
       "parameter k is -1, outside of"},
      {{{"free", "[depth, w]"}}, "there is no parameter 'w'"},
      {{{"free", "[depth, young]"}}, "needs a range"},
      {{{"materials", "{rubber: {at: all, E: young, nu: nu}}"}},
       "nothing depends on the free parameter k"},
  });
}

TEST(WrongCase, Units) {
  const auto with = [](Sections other, const std::string &unit = "mm") {
    other.insert(
        {{"units", "{length: mm, force: N}"},
         {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05, unit: " + unit + "}}"},
         {"materials", "{rubber: {at: all, E: 15 MPa, nu: 0.3}}"}});
    return other;
  };
  const auto load = [&](const std::string &text) {
    return with({{"loads", "{l: {" + text + "}}"}});
  };
  const auto spring = [&](const std::string &text) {
    return with({{"imposed", "{top: {at: top, uy: -depth}, sides: {at: sides, ux: 0}}"},
                 {"springs", "{s: {at: sides, " + text + "}}"}});
  };
  const auto turned = [&](Sections sections) {
    sections["physics"] = "axisymmetric";
    return sections;
  };
  for (const Sections &right :
       {with({}), with({}, "um"), load("at: all, force: [0, -1 N/mm^3]"),
        load("at: sides, traction: [0, 1 MPa]"), load("at: sides, pressure: 3 * depth"),
        spring("stiffness: 100 MPa, pretension: 1 N/mm, settled: depth - 2"),
        turned(spring("stiffness: 100 N/mm, pretension: 1 kN")),
        with({{"imposed",
               "{top: {at: top, ux: 0, uy: -depth}, sides: {at: sides, force_x: 1 N/mm}}"}}),
        with({{"let", "{area: depth*x + 3 * y^2, ratio: depth/x, mean: sqrt(x*depth)}"},
              {"outputs", "{far: {integral: pressure*x, where: x > depth and gap < mean}}"}})})
    EXPECT_EQ(said(block_case(right)), "") << block_case(right);
  const std::string thin = "in plane problems forces are per thickness (N/mm): ";
  expect_refused({
      {with({}, "MPa"), "a length is wanted, -depth is a stress"},
      {with({}, "foot"), "unknown unit 'foot'"},
      {with({{"let", "{deep: 2 N}"}, {"imposed", "{top: {at: top, ux: 0, uy: -depth - deep}}"}}),
       "'-depth - deep' adds or compares a length and a force"},
      {with({{"let", "{a: depth^2}"}, {"imposed", "{top: {at: top, ux: 0, uy: a/depth + a}}"}}),
       "adds or compares a length and an area"},
      {with({{"outputs", "{part: {measure: pressure > depth}}"}}), "a stress and a length"},
      {with({{"require", "{r: {that: depth < 2 and depth^2 > depth, says: no}}"}}), "an area"},
      {load("at: all, force: [0, -1 K]"), "a force per volume is wanted, -1 K is a temperature"},
      {load("at: all, force: [0, -1 s]"), "a force per volume is wanted, -1 s is a time"},
      {load("at: all, force: [0, -1 MPa]"), "a force per volume"},
      {load("at: sides, pressure: depth"), "a stress is wanted, depth is a length"},
      {spring("stiffness: 1 N/mm"), thin + "a stress is wanted"},
      {spring("pretension: 1 N"), thin + "a stiffness or a force per length is wanted, 1 N is"},
      {turned(spring("stiffness: 1 MPa")), "a stiffness or a force per length is wanted"},
      {with({{"imposed", "{top: {at: top, ux: 0, force_y: 3 N}}"}}), thin},
      {with({{"contact", "{f: {at: contact, against: {plane: {normal: [0, -1], position: 0, "
                         "tilt: depth}}}}"}}),
       "a number without dimension is wanted, depth is a length"},
      {with({{"map", "[x, y*depth]"}}), "a length is wanted, y*depth is an area"},
      {with({{"parameters", "{depth: {range: [0.01 N, 0.1], default: 0.05, unit: mm}}"}}),
       "a length is wanted, 0.01 N is a force"},
      {{{"parameters", "{depth: {range: [0.01, 0.1], default: 0.05, unit: m}, k: {range: [1, 2], "
                       "default: 1}, nu: {default: 0.3}, young: {default: 15, unit: mm}}"}},
       "mm and m are of none: write units:"},
      {{{"parameters", "{depth: {range: [0.01, 0.1], default: 0.05, unit: deg}, k: {range: [1, 2], "
                       "default: 1}, nu: {default: 0.3}, young: {default: 15}}"}},
       "deg and radians are of none: write units:"},
  });
}

/// Names that mean something else in expressions, tables or options.
TEST(WrongCase, Names) {
  const auto named = [](const std::string &name) {
    return Sections{{"parameters", "{" + name + ": {range: [0.01, 0.1], default: 0.05}}"},
                    {"materials", "{rubber: {at: all, E: 15, nu: 0.3}}"},
                    {"imposed", "{top: {at: top, ux: 0, uy: '-(" + name + ")'}}"}};
  };
  for (const std::string right : {"depth", "mu", "pressure", "pi_2", "energies", "_a"})
    EXPECT_EQ(said(block_case(named(right))), "") << right;
  for (const std::string wrong : {"pi", "sin", "max", "and", "not", "e-mod", "a b", "2nd", "a.b"})
    expect_refused({{named(wrong), "is no name that an expression can have"}});
  for (const std::string column :
       {"energy", "normal_force", "status", "id", "seconds", "energy_error", "u_enriched"})
    expect_refused({{named(column), "tables have a column '" + column + "' already"}});
  expect_refused({
      {named("nx"), "'nx' is the name of a coordinate"},
      {{{"let", "{pi: 3}"}}, "'pi' is no name"},
      {{{"outputs", "{a: {max: gap}, a_error: {max: gap}}"}}, "a column 'a_error' already"},
      {{{"outputs", "{a_error: {max: gap}, a: {max: gap}}"}}, "a column 'a' already"},
      {{{"outputs", "{status: {max: gap}}"}}, "a column 'status' already"},
  });
  CaseChanges changes;
  changes.taken = {"out", "threads"};
  for (const std::string text : {"{out: {default: a, a: {}}}", "{threads: {sets: mesh.edges}}"})
    EXPECT_THROW((void)read_case(block_case({{"choices", text}}), "x.yaml", changes), Error);
  EXPECT_THROW((void)read_case(block_case(named("out")), "x.yaml", changes), Error);
  EXPECT_NO_THROW((void)read_case(block_case(named("mu")), "x.yaml", changes));
}

} // namespace
} // namespace rbvi::wrong_cases_test
