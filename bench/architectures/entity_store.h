// Components in an entity-component store: a sparse set a component, in the manner of EnTT (M. Caini), written small.
// Of an entity's number a page says where its component stands in a dense array;
// removing moves the last one into the gap.
#pragma once
#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

namespace pcphys::architectures {

using Entity = std::uint32_t;

template <class T> class Pool {
 public:
  T& add(Entity entity) {
    const std::size_t page = entity / page_size;
    if (page >= sparse_.size()) sparse_.resize(page + 1);
    if (!sparse_[page]) {
      sparse_[page] = std::make_unique<std::uint32_t[]>(page_size);
      for (std::uint32_t i = 0; i < page_size; i++) sparse_[page][i] = none;
    }
    sparse_[page][entity % page_size] = std::uint32_t(dense_.size());
    dense_.push_back(entity);
    return components_.emplace_back();
  }
  void remove(Entity entity) {
    const std::uint32_t gap = place(entity);
    sparse_[dense_.back() / page_size][dense_.back() % page_size] = gap;
    sparse_[entity / page_size][entity % page_size] = none;
    dense_[gap] = dense_.back();
    components_[gap] = components_.back();
    dense_.pop_back();
    components_.pop_back();
  }
  bool contains(Entity entity) const {
    const std::size_t page = entity / page_size;
    return page < sparse_.size() && sparse_[page] && sparse_[page][entity % page_size] != none;
  }
  /// Where the entity's component stands in `at`.
  std::uint32_t place(Entity entity) const { return sparse_[entity / page_size][entity % page_size]; }
  T& of(Entity entity) { return components_[place(entity)]; }
  T& at(std::uint32_t place) { return components_[place]; }
  const std::vector<Entity>& entities() const { return dense_; }

 private:
  static constexpr std::uint32_t page_size = 4096, none = ~0u;
  std::vector<std::unique_ptr<std::uint32_t[]>> sparse_;
  std::vector<Entity> dense_;
  std::vector<T> components_;
};

template <class... Components> class Registry {
 public:
  Entity create() {
    if (free_.empty()) return next_++;
    const Entity entity = free_.back();
    free_.pop_back();
    return entity;
  }
  void destroy(Entity entity) {
    ((pool<Components>().contains(entity) ? pool<Components>().remove(entity) : void()), ...);
    free_.push_back(entity);
  }
  template <class T> Pool<T>& pool() { return std::get<Pool<T>>(pools_); }
  template <class T> T& add(Entity entity) { return pool<T>().add(entity); }

  /// Entities that have all of these, in the order of the first.
  template <class First, class... Rest, class Visit> void view(Visit visit) {
    for (const Entity entity : pool<First>().entities())
      if ((pool<Rest>().contains(entity) && ...)) visit(entity);
  }
  /// Where all that have the first have the rest too, and in the same order: an owning group. Visits places.
  template <class First, class Visit> void group(Visit visit) {
    const auto size = std::uint32_t(pool<First>().entities().size());
    for (std::uint32_t place = 0; place < size; place++) visit(place);
  }

 private:
  std::tuple<Pool<Components>...> pools_;
  std::vector<Entity> free_;
  Entity next_ = 0;
};

}  // namespace pcphys::architectures
