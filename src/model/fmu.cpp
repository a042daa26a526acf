#include "rbvi/model/fmu.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/output_units.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/units.hpp"
#include "rbvi/io/zip.hpp"
#include "rbvi/model/model_image.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/scene/stored_scene.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// ` name="value"`; nothing for an empty value.
std::string attribute(const std::string &name, const std::string &value) {
  std::string text;
  for (const char c : value) {
    const auto *special = std::strchr("&<\"", c);
    if (static_cast<unsigned char>(c) < ' ')
      text += ' ';
    else if (special != nullptr)
      text += "&#" + std::to_string(int(c)) + ";";
    else
      text += c;
  }
  return value.empty() ? "" : " " + name + "=\"" + text + "\"";
}

/// With its powers of the units of SI, where it is known: without a system units are labels.
std::string unit_definition(const std::string &unit) {
  const std::string head = "    <Unit" + attribute("name", unit);
  try {
    const auto [length, force, time, temperature] = dimension_of(unit);
    const bool angle = unit == "rad" || unit == "deg";
    std::string base = attribute("factor", shortest_number(from_unit(1, unit, UnitSystem{})));
    for (const auto &[name, power] :
         {std::pair{"kg", force}, std::pair{"m", length + force}, std::pair{"s", time - 2 * force},
          std::pair{"K", temperature}, std::pair{"rad", int(angle)}})
      if (power != 0) base += attribute(name, std::to_string(power));
    return head + "><BaseUnit" + base + "/></Unit>\n";
  } catch (const Error &) {
    return head + "/>\n";
  }
}

/// The elements of all variables, the inputs first; each has another name.
std::vector<std::string> variables_of(const ReducedModel &model) {
  std::vector<std::string> elements;
  std::set<std::string> names;
  std::size_t reference = 0;
  const auto add = [&](std::string name, const std::string &says, const std::string &causality,
                       const std::string &type) {
    while (!names.insert(name).second)
      name += '_';
    elements.push_back("    <ScalarVariable" + attribute("name", name) +
                       attribute("valueReference", std::to_string(reference++)) +
                       attribute("description", says) + attribute("causality", causality) +
                       (causality == "output" ? attribute("initial", "calculated") : "") + type +
                       "/></ScalarVariable>\n");
  };
  auto texts = texts_of_parameters(model.scene);
  for (int i = 0; i < model.scene.parameters.size(); ++i) {
    const Parameter &of = model.scene.parameters.at(i);
    add(of.name, texts[of.name], "input",
        "><Real" + attribute("unit", of.unit) + attribute("min", shortest_number(of.lower)) +
            attribute("max", shortest_number(of.upper)) +
            attribute("start", shortest_number(std::clamp(of.value, of.lower, of.upper))));
  }
  const std::vector<OutputColumn> columns = columns_of_model(model);
  const ErrorOfOutput errors = errors_of_outputs(model);
  for (const OutputColumn &column : columns)
    add(column.name, says_of(model.scene, column), "output",
        "><Real" + attribute("unit", unit_of(model.scene, column)));
  for (const OutputColumn &column : columns)
    if (errors.contains(column.name))
      add(column.name + "_error",
          "largest error of " + column.name + " over the validation set, absolute", "output",
          "><Real" + attribute("unit", unit_of(model.scene, column)));
    else
      ++reference;
  add("residual", "of the reduced problem, relative", "output", "><Real");
  reference = 0; // of integers
  add("status", "0: an answer, 1: there is none, 2: an input is wrong; outputs are NaN then",
      "output", attribute("variability", "discrete") + "><Integer min=\"0\" max=\"2\"");
  return elements;
}

/// A name in C.
std::string identifier_of(const ReducedModel &model) {
  std::string name = "rbvi_" + model.scene.name;
  for (char &c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

} // namespace

fs::path library_of_units() {
  const char *name = "librbvi_fmu.so";
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char *folder : {"", "..", "../" RBVI_LIBDIR, "../lib"})
    if (fs::path file = program / folder / name; fs::is_regular_file(file, error)) return file;
  throw failure(std::string(name) + " is neither in " + program.string() +
                " nor where a build or an install has it: build the target rbvi_fmu");
}

std::string model_description(const ReducedModel &model, const std::string &guid) {
  std::set<std::string> units;
  const int inputs = model.scene.parameters.size();
  for (int i = 0; i < inputs; ++i)
    units.insert(model.scene.parameters.at(i).unit);
  for (const OutputColumn &column : columns_of_model(model))
    units.insert(unit_of(model.scene, column));
  units.erase("");
  std::string definitions, unknowns;
  for (const std::string &unit : units)
    definitions += unit_definition(unit);
  if (!units.empty())
    definitions = "  <UnitDefinitions>\n" + definitions + "  </UnitDefinitions>\n";
  const std::vector<std::string> variables = variables_of(model);
  for (auto i = static_cast<std::size_t>(inputs); i < variables.size(); ++i)
    unknowns += "      <Unknown" + attribute("index", std::to_string(i + 1)) + "/>\n";
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" generationTool="rbvi )" RBVI_VERSION "\"" +
         attribute("modelName", model.scene.name) + attribute("guid", guid) + ">\n  <CoSimulation" +
         attribute("modelIdentifier", identifier_of(model)) +
         R"( canHandleVariableCommunicationStepSize="true" canInterpolateInputs="false"
    canBeInstantiatedOnlyOncePerProcess="false" canNotUseMemoryManagementFunctions="true"
    canGetAndSetFMUstate="false" providesDirectionalDerivative="true"/>
)" + definitions +
         R"(  <LogCategories>
    <Category name="logStatusWarning"/><Category name="logStatusDiscard"/><Category name="logStatusError"/>
  </LogCategories>
  <ModelVariables>
)" + joined(variables, "") +
         "  </ModelVariables>\n  <ModelStructure>\n    <Outputs>\n" + unknowns +
         "    </Outputs>\n    <InitialUnknowns>\n" + unknowns +
         "    </InitialUnknowns>\n  </ModelStructure>\n</fmiModelDescription>\n";
}

std::string fmu_of(const ReducedModel &model, const fs::path &library) {
  const std::string image = image_of(model);
  const Bytes bytes = std::as_bytes(std::span(image));
  const ReducedModel opened = // as the unit opens it
      model_in(bytes, "the image for the unit", Registry{}, false);
  const std::vector<std::byte> code = bytes_of_file(library);
  const auto *text = reinterpret_cast<const char *>(code.data()); // NOLINT: bytes of a file
  return zip_of(
      {{"modelDescription.xml", model_description(opened, guid_of(bytes))},
       {"binaries/linux64/" + identifier_of(opened) + ".so", std::string(text, code.size())},
       {"resources/model.rbvi", image}});
}

} // namespace rbvi
