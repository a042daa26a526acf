#include "rbvi/scene/stored_scene.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/scene/case.hpp"
#include "reader.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace rbvi {

namespace {

constexpr const char *held_bodies = "held_by_contact"; ///< of a tree: a list of terms of a

using Values = std::vector<std::pair<std::string, std::string>>;

template <class Unwanted> void take_away(CaseNode &table, Unwanted &&unwanted) {
  std::erase_if(table.entries, [&](const CaseNode::Entry &entry) { return unwanted(entry); });
}

CaseNode *section_of(CaseNode &root, const std::string &name) {
  const auto found = std::ranges::find(root.entries, name, &CaseNode::Entry::name);
  return found == root.entries.end() ? nullptr : &found->node;
}

/// The names that the values of a tree may be.
void collect_words(const CaseNode &node, std::set<std::string> &words) {
  std::string word;
  for (const char c : node.value + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
      word += c;
    } else if (!word.empty()) {
      words.insert(std::move(word));
      word.clear();
    }
  }
  for (const CaseNode &item : node.items)
    collect_words(item, words);
  for (const auto &[name, entry] : node.entries)
    collect_words(entry, words);
}

/// Takes parameters and lets away that nothing else names.
void take_away_unnamed(CaseNode &root) {
  const auto declares = [](const CaseNode::Entry &section) {
    return section.name == "parameters" || section.name == "let";
  };
  std::set<std::string> words;
  for (const CaseNode::Entry &section : root.entries)
    if (!declares(section)) collect_words(section.node, words);
  for (std::size_t before = 0; before != words.size();) {
    before = words.size();
    for (const CaseNode::Entry &section : root.entries)
      for (const auto &[name, node] : declares(section) ? section.node.entries : CaseNode().entries)
        if (words.contains(name)) collect_words(node, words);
  }
  for (CaseNode::Entry &section : root.entries)
    if (declares(section))
      take_away(section.node, [&](const auto &entry) { return !words.contains(entry.name); });
  take_away(root, [&](const CaseNode::Entry &section) {
    return declares(section) && section.node.entries.empty();
  });
}

/// What answers depend on.
CaseNode counted(const std::string &tree, Compared compared) {
  CaseNode root = tree_in(tree);
  const std::set<std::string> idle{held_bodies, "rbvi",     "name",    "says",  "free",
                                   "train",     "validate", "require", "tests", "small"};
  take_away(root, [&](const CaseNode::Entry &section) {
    return idle.contains(section.name) ||
           (section.name == "outputs" && compared == Compared::answers);
  });
  if (CaseNode *mesh = section_of(root, "mesh")) // what it is made of, its fingerprint tells
    take_away(*mesh, [](const CaseNode::Entry &entry) {
      return entry.name == "file" || entry.name == "set" || entry.name == "facts" ||
             entry.name == "edges";
    });
  if (CaseNode *parameters = section_of(root, "parameters"))
    for (auto &[name, node] : parameters->entries)
      take_away(node, [varies = !is_constant(node)](const CaseNode::Entry &entry) {
        return entry.name == "range" || entry.name == "limits" || entry.name == "says" ||
               (entry.name == "default" && varies);
      });
  if (CaseNode *outputs = section_of(root, "outputs"))
    for (auto &[name, node] : outputs->entries)
      take_away(node, [](const CaseNode::Entry &entry) { return entry.name == "says"; });
  take_away_unnamed(root);
  return root;
}

/// Paths by the place of a contact, a load, ... in its section in place of its name.
Values with_places(CaseNode root) {
  for (const char *section : {"materials", "imposed", "loads", "springs", "contact"})
    if (CaseNode *table = section_of(root, section))
      for (std::size_t i = 0; i < table->entries.size(); ++i)
        table->entries[i].name = std::to_string(i);
  return values_of(root);
}

/// "young" of parameters.young.default, "friction.coulomb of floor" of
/// contact.floor.friction.coulomb; what has no name of its own is a path.
std::string in_words(const std::string &path) {
  static const std::set<std::string> with_names{"materials", "imposed",    "loads", "springs",
                                                "contact",   "parameters", "let",   "outputs"};
  const std::size_t section = path.find('.'), name = path.find('.', section + 1);
  if (section == std::string::npos || path.find('\\') != std::string::npos ||
      !with_names.contains(path.substr(0, section)))
    return path;
  const std::string of = path.substr(section + 1, name - section - 1),
                    what = name == std::string::npos ? "" : path.substr(name + 1);
  const bool value = path.starts_with("parameters.") && what == "default";
  return what.empty() || value ? of : what + " of " + of;
}

/// Null: nothing stands there.
const std::string *value_at(const Values &values, const std::string &path) {
  const auto found = std::ranges::find(values, path, &Values::value_type::first);
  return found == values.end() ? nullptr : &found->second;
}

} // namespace

void add_held_body(Scene &scene, int of) {
  const CaseNode root = tree_in(scene.tree), *held = root.find(held_bodies);
  if (held == nullptr)
    scene.f.push_back(
        exact_term(body_load("", everywhere(Point{}), scene.components, scene.degree)));
  const std::vector<Factor> theta = of < 0 ? std::vector<Factor>{} : scene.a.at(of).theta.value();
  scene.a.push_back(exact_term(elasticity("", Lame{0, 0}, scene.degree), theta));
  scene.tree += std::string(held_bodies) + "[" +
                std::to_string(held == nullptr ? 0 : held->items.size()) +
                "]: " + std::to_string(of) + "\n";
}

namespace {

/// Without bodies that contact alone holds.
Scene scene_of(const CaseNode &root, const std::string &tree, const SceneOptions &options,
               const Registry &registry) {
  if (const CaseNode *program = root.find("program")) {
    Scene scene = while_doing("making the scene of a program by its entry", [&] {
      return make_scene(entry_of(registry, program->value), options);
    });
    if (const std::string difference = scene_difference(tree, scene.tree); !difference.empty())
      throw bad_input("the program's scene " + program->value + " is another one: " + difference +
                      ": make the model again, or use the program that made it");
    return scene;
  }
  if (root.entries.empty())
    throw bad_input(
        "a scene without a name cannot be made again: make it by an entry of a registry "
        "(make_scene)");
  Scene scene = read_scene(root);
  scene.options = options;
  return scene;
}

} // namespace

Scene scene_in(const std::string &tree, const SceneOptions &options, const Registry &registry) {
  CaseNode root = tree_in(tree);
  const CaseNode *held = root.find(held_bodies);
  const std::vector<CaseNode> terms = held == nullptr ? std::vector<CaseNode>{} : held->items;
  take_away(root, [](const CaseNode::Entry &entry) { return entry.name == held_bodies; });
  Scene scene = scene_of(root, tree, options, registry);
  for (const CaseNode &term : terms)
    add_held_body(scene, static_cast<int>(parse_number(term.value, held_bodies)));
  return scene;
}

std::map<std::string, std::string> texts_of_parameters(const Scene &scene) {
  std::map<std::string, std::string> texts;
  const CaseNode tree = tree_in(scene.tree);
  if (const CaseNode *parameters = tree.find("parameters"))
    for (const auto &[name, node] : parameters->entries) {
      if (const CaseNode *says = node.find("says")) texts[name] = says->value;
      if (const CaseNode *values = node.find("values"); values != nullptr)
        texts[name] +=
            (texts[name].empty() ? "" : "; ") + joined(names_in(*values)) + " are 0, 1, ...";
    }
  return texts;
}

std::string scene_difference(const std::string &theirs, const std::string &mine,
                             Compared compared) {
  if (theirs == mine) return "";
  const CaseNode before = counted(theirs, compared), now = counted(mine, compared);
  const Values old_values = with_places(before), values = with_places(now),
               old_names = values_of(before), names = values_of(now);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string *old = value_at(old_values, values[i].first);
    if (old == nullptr || *old != values[i].second)
      return in_words(names[i].first) + " is " + values[i].second + ", it was " +
             (old == nullptr ? "not there" : *old);
  }
  for (std::size_t i = 0; i < old_values.size(); ++i)
    if (value_at(values, old_values[i].first) == nullptr)
      return in_words(old_names[i].first) + " was " + old_values[i].second + " and is gone";
  return "";
}

} // namespace rbvi
