#include "rbvi/tool/cases.hpp"

#include "database.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"
#include "run_directory.hpp"
#include "table.hpp"

#include <algorithm>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// Where the case of a folder stands.
fs::path in_folder(const fs::path &file) {
  std::error_code ignored;
  return fs::is_regular_file(file / "case.yaml", ignored) ? file / "case.yaml" : file;
}

/// -case, or the options that a run directory was made with; "": there are none, -scene is given.
std::string file_of_run() {
  const std::string file = text_of("case"), out = text_of("out");
  if (!file.empty()) return in_folder(file).string();
  if (!out.empty() && fs::exists(case_of_run(out))) return case_of_run(out).string();
  if (is_given("scene")) return "";
  throw bad_input("no case is named" +
                  (out.empty() ? "" : ", and " + out + " is no directory of a run") +
                  ": use -case cases/NAME/case.yaml (rbvi list)");
}

const CaseSetting *find(const std::vector<CaseSetting> &options, const std::string &name) {
  const auto found = std::ranges::find(options, name, &CaseSetting::name);
  return found == options.end() ? nullptr : &*found;
}

/// Options that are not on the command line. Their files are beside `file`.
void insert(const std::vector<CaseSetting> &options, const std::string &file,
            const std::vector<std::string> &command_line,
            std::map<std::string, std::string> &origin) {
  for (const CaseSetting &option : options) {
    if (option.name == "case" || contains(command_line, option.name)) continue;
    const std::string value = beside_case(option.name, option.value, file);
    RBVI_CALL(PetscOptionsSetValue(nullptr, ("-" + option.name).c_str(),
                                   value.empty() ? nullptr : value.c_str()));
    origin[option.name] = " (line " + std::to_string(option.line) + " of " + file + ")";
  }
}

/// The case that a file of options names. Throws bad_input for one as case files once were.
std::string case_of_options(const std::vector<CaseSetting> &options, const std::string &file) {
  if (const CaseSetting *of = find(options, "case"))
    return in_folder(beside_case("case", of->value, file)).string();
  const CaseSetting *scene = find(options, "scene");
  throw bad_input(file + " is a list of options and names no case: a case file holds its scene " +
                  "('rbvi: 1', 'physics: ...', its options below 'options:'), a list of options " +
                  "begins with 'case: FILE', such as 'case: cases/" +
                  (scene == nullptr ? "NAME" : scene->value) + "/case.yaml' (cases/CASE_FILE.md)");
}

bool is_own(const std::string &scene, const Registry &registry) {
  return std::ranges::find(registry, scene, &SceneEntry::name) != registry.end();
}

/// A scene that the program has by itself.
GivenCase own_scene(const std::string &scene, const Registry &registry) {
  if (!is_own(scene, registry))
    throw bad_input("unknown scene '" + scene +
                    "': -scene names scenes of a program of its own; "
                    "use -case cases/" +
                    scene);
  return {std::make_shared<Registry>(registry), scene};
}

CaseChanges changes_of_run() {
  return {text_of("variant"), settings_of(text_of("set")), taken_names()};
}

/// The text with the name that its file gives the scene.
std::string named_text(const std::string &text, const std::string &name) {
  const CaseNode root = parse_document(text, name);
  return root.find("name") != nullptr ? text : case_line("name", name) + text;
}

} // namespace

std::vector<std::pair<std::string, std::string>> settings_of(const std::string &text) {
  std::vector<std::pair<std::string, std::string>> settings;
  for (const std::string &part : split(text, ',')) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos && equals > 0)
      settings.emplace_back(trimmed(part.substr(0, equals)), trimmed(part.substr(equals + 1)));
    else if (!settings.empty() && equals == std::string::npos) // of the value before it
      settings.back().second += "," + part;
    else
      throw bad_input("-set is '" + text + "': give PATH=VALUE, such as mesh.edges=200");
  }
  return settings;
}

GivenCase insert_case(MPI_Comm comm, const std::vector<std::string> &command_line,
                      const Registry &registry) {
  std::string file;
  collectively(comm, [&] { file = file_of_run(); });
  if (file.empty()) return own_scene(text_of("scene"), registry);
  GivenCase given;
  std::string text = read_case_text(comm, file);
  if (!is_scene_file(text, file)) {
    const std::vector<CaseSetting> options = parse_options(text, file);
    insert(options, file, command_line, given.origin);
    if (is_own(text_of("scene"), registry)) {
      GivenCase known = own_scene(text_of("scene"), registry);
      known.origin = given.origin;
      return known;
    }
    file = case_of_options(options, file);
    text = read_case_text(comm, file);
    if (!is_scene_file(text, file))
      throw bad_input("the case " + file + " is a list of options, too: name one with a scene");
  }
  if (is_given("scene"))
    throw bad_input("-scene names a scene of the program, and " + file +
                    " is a case: leave out one of the two");
  SceneEntry entry = read_case(text, file, changes_of_run());
  std::vector<std::string> above = command_line; // what the case itself sets comes below
  for (const auto &[name, where] : given.origin)
    above.push_back(name);
  insert(entry.settings, file, above, given.origin);
  given.scene = entry.name;
  given.text = named_text(text, entry.name);
  auto known = std::make_shared<Registry>(registry);
  std::erase_if((*known), [&](const SceneEntry &other) { return other.name == entry.name; });
  (*known).push_back(std::move(entry));
  given.registry = std::move(known);
  return given;
}

SceneEntry scene_of_file(MPI_Comm comm, const fs::path &file, const CaseChanges &changes) {
  const fs::path at = in_folder(file);
  return read_case(read_case_text(comm, at), at.string(), changes);
}

std::vector<SceneEntry> cases_in(const fs::path &folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry &entry : fs::directory_iterator(folder, ignored))
    if (fs::is_regular_file(entry.path() / "case.yaml", ignored))
      files.push_back(entry.path() / "case.yaml");
  std::ranges::sort(files);
  std::vector<SceneEntry> cases;
  for (const fs::path &file : files)
    cases.push_back(scene_of_file(MPI_COMM_SELF, file));
  return cases;
}

} // namespace rbvi
