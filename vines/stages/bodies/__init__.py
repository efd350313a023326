"""Bodies of the kinds: what a stage computes, imported only when there is something to compute."""
