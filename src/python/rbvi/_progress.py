"""How far a long table is, on standard error."""

import sys
import time
from concurrent.futures import ThreadPoolExecutor, wait

EVERY = 0.5  # seconds


def shown_while(work, done, total, wanted):
    """work(), with a line that says how many of `total` are done, as done() counts; `wanted` None: on
    a terminal, from two seconds on."""
    after = 0
    if wanted is None:
        wanted, after = sys.stderr.isatty(), 2
    if not wanted:
        work()
        return
    began, shown = time.monotonic(), False
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(work)
        while not wait([running], EVERY).done:
            seconds, count = time.monotonic() - began, done()
            if seconds < after:
                continue
            left = f", {seconds / count * (total - count):.0f} s left" if count else ""
            print(f"\r  {count} of {total} answers{left}\x1b[K", end="", file=sys.stderr, flush=True)
            shown = True
    if shown:
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    running.result()
