/** What a form does when it is submitted: the action, instead of a load of a new page. */

export const submit = (action: () => unknown) => (event: SubmitEvent) => {
  event.preventDefault();
  void action();
};
