// Lists of variants: a library beside this one enters its own, at the start of a program.
#pragma once

#include "rbvi/core/error.hpp"

#include <map>
#include <string>

namespace rbvi {

/// What is said where a program asks for a variant that it was not linked with; `name`: for users.
inline Error not_entered(const std::string &name) {
  return bad_input(name + " is a published variant, which this program does not have: link "
                          "rbvi::published_offline or rbvi::published_online, and call "
                          "add_published_reductions() or add_published_queries() first");
}

/// The entry of `key`. Throws bad_input where there is none.
template <class Key, class Value>
const Value &entered(const std::map<Key, Value> &list, const Key &key, const std::string &name) {
  const auto found = list.find(key);
  if (found == list.end()) throw not_entered(name);
  return found->second;
}

} // namespace rbvi
