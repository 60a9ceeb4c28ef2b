/* What the queues of Concurrency Kit do, for C++: its headers are C and do not compile as C++.
   Places and entries hold one pointer-sized word. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct irt_ck_fifo;
struct irt_ck_ring;

/* A ck_fifo_mpmc_entry: room for one node of a fifo. */
struct irt_ck_entry {
  __attribute__((aligned(16))) unsigned char bytes[32];
};

/* A fifo that starts with `sentinel`; NULL if there is no memory. */
struct irt_ck_fifo* irt_ck_fifo_new(struct irt_ck_entry* sentinel);
void irt_ck_fifo_delete(struct irt_ck_fifo* fifo);
void irt_ck_fifo_push(struct irt_ck_fifo* fifo, struct irt_ck_entry* entry, uint64_t word);
/* Takes the oldest word; `left` is then the entry that is no longer part of the fifo. */
bool irt_ck_fifo_pop(struct irt_ck_fifo* fifo, uint64_t* word, struct irt_ck_entry** left);

/* A ring of `size` places, a power of two of which one always stays free; NULL if there is no
   memory. */
struct irt_ck_ring* irt_ck_ring_new(unsigned size);
void irt_ck_ring_delete(struct irt_ck_ring* ring);
bool irt_ck_ring_push(struct irt_ck_ring* ring, uint64_t word);
bool irt_ck_ring_pop(struct irt_ck_ring* ring, uint64_t* word);
/* The same for one thread that pushes and many that pop; many that push and one that pops. */
bool irt_ck_ring_push_spmc(struct irt_ck_ring* ring, uint64_t word);
bool irt_ck_ring_pop_spmc(struct irt_ck_ring* ring, uint64_t* word);
bool irt_ck_ring_push_mpsc(struct irt_ck_ring* ring, uint64_t word);
bool irt_ck_ring_pop_mpsc(struct irt_ck_ring* ring, uint64_t* word);

#ifdef __cplusplus
}
#endif
