#include "queues/comparators/concurrency_kit.h"

#include <ck_fifo.h>
#include <ck_ring.h>
#include <stddef.h>
#include <stdlib.h>

enum { line = 128 };

struct irt_ck_fifo {
  struct ck_fifo_mpmc fifo;
};

struct irt_ck_ring {
  struct ck_ring ring;
  ck_ring_buffer_t* places;
};

_Static_assert(sizeof(struct ck_fifo_mpmc_entry) <= sizeof(struct irt_ck_entry),
               "irt_ck_entry must have room for an entry");
_Static_assert(sizeof(void*) == sizeof(uint64_t), "a word must fit into a pointer");

static void* allocate_lines(size_t bytes) {
  return aligned_alloc(line, (bytes + line - 1) / line * line);
}

struct irt_ck_fifo* irt_ck_fifo_new(struct irt_ck_entry* sentinel) {
  struct irt_ck_fifo* fifo = allocate_lines(sizeof *fifo);
  if (fifo != NULL) ck_fifo_mpmc_init(&fifo->fifo, (struct ck_fifo_mpmc_entry*)sentinel);
  return fifo;
}

void irt_ck_fifo_delete(struct irt_ck_fifo* fifo) {
  free(fifo);
}

void irt_ck_fifo_push(struct irt_ck_fifo* fifo, struct irt_ck_entry* entry, uint64_t word) {
  ck_fifo_mpmc_enqueue(&fifo->fifo, (struct ck_fifo_mpmc_entry*)entry, (void*)word);
}

bool irt_ck_fifo_pop(struct irt_ck_fifo* fifo, uint64_t* word, struct irt_ck_entry** left) {
  return ck_fifo_mpmc_dequeue(&fifo->fifo, word, (struct ck_fifo_mpmc_entry**)left);
}

struct irt_ck_ring* irt_ck_ring_new(unsigned size) {
  struct irt_ck_ring* ring = allocate_lines(sizeof *ring);
  if (ring == NULL) return NULL;
  ring->places = calloc(size, sizeof *ring->places);
  if (ring->places == NULL) {
    free(ring);
    return NULL;
  }
  ck_ring_init(&ring->ring, size);
  return ring;
}

void irt_ck_ring_delete(struct irt_ck_ring* ring) {
  free(ring->places);
  free(ring);
}

bool irt_ck_ring_push(struct irt_ck_ring* ring, uint64_t word) {
  return ck_ring_enqueue_mpmc(&ring->ring, ring->places, (void*)word);
}

bool irt_ck_ring_pop(struct irt_ck_ring* ring, uint64_t* word) {
  return ck_ring_dequeue_mpmc(&ring->ring, ring->places, word);
}

bool irt_ck_ring_push_spmc(struct irt_ck_ring* ring, uint64_t word) {
  return ck_ring_enqueue_spmc(&ring->ring, ring->places, (void*)word);
}

bool irt_ck_ring_pop_spmc(struct irt_ck_ring* ring, uint64_t* word) {
  return ck_ring_dequeue_spmc(&ring->ring, ring->places, word);
}

bool irt_ck_ring_push_mpsc(struct irt_ck_ring* ring, uint64_t word) {
  return ck_ring_enqueue_mpsc(&ring->ring, ring->places, (void*)word);
}

bool irt_ck_ring_pop_mpsc(struct irt_ck_ring* ring, uint64_t* word) {
  return ck_ring_dequeue_mpsc(&ring->ring, ring->places, word);
}
