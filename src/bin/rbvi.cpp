#include "rbvi/contact/registry.hpp"
#include "rbvi/tool/rbvi_main.hpp"

int main(int argc, char **argv) {
  return rbvi::rbvi_main(argc, argv, rbvi::registry_of({}));
}
