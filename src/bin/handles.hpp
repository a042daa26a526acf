// Handles of the C interface: numbers that are never used twice, so that one that was closed is
// known as such.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>

namespace rbvi {

template <class Handle, class Object> class Handles {
public:
  Handle *add(std::shared_ptr<Object> object) {
    const std::unique_lock lock(mutex_);
    const std::uintptr_t number = 16 * ++count_;
    objects_.emplace(number, std::move(object));
    return reinterpret_cast<Handle *>(number); // NOLINT: nothing is at this address
  }
  /// Null for a handle that is none.
  std::shared_ptr<Object> find(const Handle *handle) const {
    const std::shared_lock lock(mutex_);
    const auto found = objects_.find(reinterpret_cast<std::uintptr_t>(handle)); // NOLINT
    return found == objects_.end() ? nullptr : found->second;
  }
  void remove(const Handle *handle) {
    std::unique_lock lock(mutex_);
    const auto removed = objects_.extract(reinterpret_cast<std::uintptr_t>(handle)); // NOLINT
    lock.unlock(); // the object ends without it
  }

private:
  mutable std::shared_mutex mutex_;
  std::unordered_map<std::uintptr_t, std::shared_ptr<Object>> objects_;
  std::uintptr_t count_ = 0;
};

} // namespace rbvi
