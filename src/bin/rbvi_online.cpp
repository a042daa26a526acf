#include "rbvi/contact/registry.hpp"
#include "rbvi/model/online_tool.hpp"

int main(int argc, char **argv) {
  return rbvi::rbvi_online_main(argc, argv, rbvi::registry_of({}));
}
