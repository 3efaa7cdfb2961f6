// An area of storage. A browser may refuse it, as a whole or when it is full: `write` is then false.
function area(name) {
  const attempt = (act, otherwise) => {
    try {
      return act(window[name]);
    } catch {
      return otherwise;
    }
  };
  return {
    read: (key) => attempt((store) => store.getItem(key), null),
    write: (key, value) => attempt((store) => (store.setItem(key, value), true), false),
    remove: (key) => attempt((store) => (store.removeItem(key), true), false),
    keys: () => attempt((store) => Object.keys(store), []),
  };
}
export const session = area("sessionStorage");
export const local = area("localStorage");
